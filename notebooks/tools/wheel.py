"""A wheel carries the chapters as `segmap/notebooks`; a clone has them beside the package."""

from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class ChaptersHook(BuildHookInterface):
    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        if version == "editable":
            return
        folder = Path(self.root, "notebooks")
        files = [*folder.glob("*.ipynb"), folder / "SYLLABUS.md", *folder.glob("pictures/*")]
        inside = {str(p): f"segmap/notebooks/{p.relative_to(folder)}" for p in files}
        build_data["force_include"].update(inside)
