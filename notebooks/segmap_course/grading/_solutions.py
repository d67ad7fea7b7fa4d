"""Solutions: the library's own source below the stub, and an answer to each open exercise."""

from __future__ import annotations

import ast
import re
import sys
from inspect import getmodule, getsource, unwrap
from types import ModuleType

from .. import EXERCISES, OPEN_EXERCISES
from ..exercises import Exercise
from ..exercises.open import Prediction
from ._inputs import INPUTS


def solution(task: str, names: str) -> str:
    """A cell that defines `names`, as a task asks for them."""
    if task in EXERCISES:
        return written_out(EXERCISES[task], names)
    exercise = OPEN_EXERCISES[task]
    if isinstance(exercise, Prediction):
        return f"{names} = {exercise.measure():.6g}  # {exercise.unit}"
    return f"import numpy as np\n\n{names} = {INPUTS[task]}"


def written_out(exercise: Exercise, name: str) -> str:
    """The library's function under another name; what it calls is imported from beside it."""
    module = sys.modules[exercise.draw.__module__]
    (exercise_call,) = (
        node.value
        for node in ast.parse(getsource(module)).body
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == f"check_{exercise.name}"
    )
    assert isinstance(exercise_call, ast.Call)
    source = f"{name} = {ast.unparse(exercise_call.args[1])}"
    if isinstance(exercise_call.args[1], ast.Name):
        function = unwrap(exercise.solution)
        module = getmodule(function) or module
        source = re.sub(rf"(?<![\w.]){function.__name__}\b", name, getsource(function))
    used = {node.id for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Name)}
    values = {one: vars(module)[one] for one in sorted(used & set(vars(module)))}
    modules = {one: value for one, value in values.items() if isinstance(value, ModuleType)}
    lines = [f"import {value.__name__} as {one}" for one, value in modules.items()]
    if others := sorted(values.keys() - modules.keys()):
        lines.append(f"from {module.__name__} import {', '.join(others)}")
    return "\n".join([*lines, "", source.strip()])
