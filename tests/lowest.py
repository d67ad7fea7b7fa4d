"""Print the lowest version of each package that pyproject.toml allows, as constraints for pip."""

import re
import tomllib
from pathlib import Path


def lowest(text: str) -> list[str]:
    """Constraints from the text of a pyproject.toml; what has no lower bound is left out."""
    project = tomllib.loads(text)["project"]
    wanted = [project["dependencies"], *project["optional-dependencies"].values()]
    bounds = (re.sub(r"\[.*?\]", "", line) for lines in wanted for line in lines)
    return [line.replace(">=", "==") for line in bounds if ">=" in line]


if __name__ == "__main__":
    root = Path(__file__).resolve().parents[1]
    print("\n".join(lowest((root / "pyproject.toml").read_text(encoding="utf-8"))))
