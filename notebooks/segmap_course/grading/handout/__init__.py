"""Handing out: student copies of the chapters, and solutions from the library's own source."""

from ._handout import (
    KIND,
    handout,
)
from ._places import (
    chapters,
    defines,
    read_chapter,
)
from ._solutions import (
    write_solutions,
)
from ._tasks import (
    Task,
    tasks_of,
)
