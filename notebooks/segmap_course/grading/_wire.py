"""Arguments of cases as plain text, from the grader to the process that runs a student's code.

Only this way: what comes back is numbers (see `exercises/_answers.py`), and never becomes code.
"""

from __future__ import annotations

import base64
import dataclasses
import importlib
import marshal
import types
from typing import Any

import numpy as np

#: Kinds that JSON would change, each under a key of its own.
_KINDS = ("array", "tuple", "bytes", "function", "object", "scalar")


def packed(value: Any) -> Any:
    """A value of a case as JSON holds it.

    Raises
    ------
    TypeError
        For a kind that no case has so far.

    Examples
    --------
    >>> packed((2, np.array([1.0])))
    {'tuple': [2, {'array': [1.0], 'kind': '<f8', 'shape': [1]}]}
    >>> unpacked(packed(((1, 2.5), None)))
    ((1, 2.5), None)
    """
    if isinstance(value, np.ndarray):
        flat = value.ravel().tolist()
        return {"array": flat, "kind": value.dtype.str, "shape": list(value.shape)}
    if isinstance(value, np.generic):
        return {"scalar": value.item(), "kind": value.dtype.str}
    if isinstance(value, tuple):
        return {"tuple": [packed(part) for part in value]}
    if isinstance(value, list):
        return [packed(part) for part in value]
    if isinstance(value, dict):
        return {name: packed(part) for name, part in value.items()}
    if isinstance(value, bytes):
        return {"bytes": value.decode("latin-1")}
    if isinstance(value, types.FunctionType):
        return _packed_function(value)
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        held = {
            field.name: packed(getattr(value, field.name)) for field in dataclasses.fields(value)
        }
        return {"object": type(value).__name__, "module": type(value).__module__, "held": held}
    if value is None or isinstance(value, bool | int | float | str):
        return value
    raise TypeError(f"a case holds a {type(value).__name__}: teach `packed` how it is sent")


def _packed_function(value: types.FunctionType) -> dict[str, Any]:
    """The code of a function of a case, a score for instance, with what it closes over."""
    held = [packed(cell.cell_contents) for cell in value.__closure__ or ()]
    text = base64.b64encode(marshal.dumps(value.__code__)).decode()
    return {"function": text, "module": value.__module__, "held": held}


def unpacked(value: Any) -> Any:
    """What `packed` packed."""
    if isinstance(value, list):
        return [unpacked(part) for part in value]
    if not isinstance(value, dict):
        return value
    kind = next((kind for kind in _KINDS if kind in value), "")
    if kind == "array":
        return np.array(value["array"], value["kind"]).reshape(value["shape"])
    if kind == "scalar":
        return np.dtype(value["kind"]).type(value["scalar"])
    if kind == "tuple":
        return tuple(unpacked(part) for part in value["tuple"])
    if kind == "bytes":
        return value["bytes"].encode("latin-1")
    if kind == "function":
        return _unpacked_function(value)
    if kind == "object":
        made = getattr(importlib.import_module(value["module"]), value["object"])
        return made(**{name: unpacked(part) for name, part in value["held"].items()})
    return {name: unpacked(part) for name, part in value.items()}


def _unpacked_function(value: dict[str, Any]) -> types.FunctionType:
    code = marshal.loads(base64.b64decode(value["function"]))
    scope = vars(importlib.import_module(value["module"]))
    held = tuple(types.CellType(unpacked(part)) for part in value["held"])
    return types.FunctionType(code, scope, code.co_name, None, held)
