"""The registry of operations: it scans `tools/ops`, so adding an operation means adding a file there."""

from __future__ import annotations

import importlib
import pkgutil
from contextlib import suppress
from functools import reduce
from operator import or_
from typing import TYPE_CHECKING, Annotated, Any, get_args

from pydantic import ConfigDict, Field, TypeAdapter, ValidationError

from ..gaussians.errors import UserError
from . import ops as _package
from .operation import EditOp


def _scan() -> dict[str, type[EditOp]]:
    """Every concrete `EditOp` defined in a module of `tools/ops`, by name, in alphabetical order."""
    found: dict[str, type[EditOp]] = {}
    for module in sorted(m.name for m in pkgutil.iter_modules(_package.__path__)):
        loaded = importlib.import_module(f"{_package.__name__}.{module}")
        for value in vars(loaded).values():
            if isinstance(value, type) and issubclass(value, EditOp) and value.__module__ == loaded.__name__:
                found[_name(value)] = value
    return dict(sorted(found.items()))


def _name(cls: type[EditOp]) -> str:
    names = get_args(cls.model_fields["op"].annotation)
    assert len(names) == 1, f"{cls.__name__}.op must be Literal of one name"
    return str(names[0])


OPS: dict[str, type[EditOp]] = _scan()

if TYPE_CHECKING:
    AnyOp = EditOp
else:
    AnyOp = Annotated[reduce(or_, OPS.values()), Field(discriminator="op")]

_ONE: TypeAdapter[EditOp] = TypeAdapter(AnyOp, config=ConfigDict(defer_build=True))


def schema() -> dict[str, Any]:
    """JSON schema of one operation: a union discriminated by `op`."""
    return _ONE.json_schema()


def parse(data: dict[str, Any] | str | bytes) -> EditOp:
    """An operation from a JSON object or its text.

    Raises:
        UserError: the data are no valid operation; the message names the field and what it allows.
    """
    if isinstance(data, dict) and (kind := OPS.get(str(data.get("op")))) is not None:
        with suppress(ValidationError):  # the union tells what is wrong, and names the operation
            return kind.model_validate(data)
    try:
        return _ONE.validate_json(data) if isinstance(data, str | bytes) else _ONE.validate_python(data)
    except ValidationError as error:
        told = "; ".join(f"{'.'.join(str(p) for p in e['loc']) or 'operation'}: {e['msg']}" for e in error.errors()[:4])
        raise UserError(f"not a valid operation ({told}); operations are {', '.join(OPS)}") from error


def describe() -> list[tuple[str, str, str, dict[str, Any]]]:
    """Name, docstring, example words and example JSON of each operation: for help pages, prompts and tool servers."""
    return [(name, (cls.__doc__ or "").strip(), *cls.example) for name, cls in OPS.items()]
