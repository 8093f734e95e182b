"""The texts behind the fields of a model's class, read from its source when a schema is asked for.

pydantic's own `use_attribute_docstrings` reads the source when the class is made, which every command would pay for.
"""

from __future__ import annotations

import ast
import inspect
import textwrap
from functools import cache
from itertools import pairwise

from pydantic import BaseModel


def described(model: type[BaseModel], properties: dict[str, dict[str, object]]) -> None:
    """Give the properties of a model's schema, by field, the texts behind the fields, unless they have descriptions."""
    texts = {name: text for base in reversed(model.__mro__) for name, text in field_texts(base).items()}
    for name, schema in properties.items():
        if name in texts:
            schema.setdefault("description", texts[name])


@cache
def field_texts(cls: type) -> dict[str, str]:
    """The text behind each annotated field of the class itself, by field; empty if there is no source."""
    if not issubclass(cls, BaseModel) or cls is BaseModel:
        return {}
    try:
        (parsed,) = ast.parse(textwrap.dedent(inspect.getsource(cls))).body
    except (OSError, TypeError, SyntaxError):
        return {}
    assert isinstance(parsed, ast.ClassDef)
    found = {}
    for field, text in pairwise(parsed.body):
        if (
            isinstance(field, ast.AnnAssign)
            and isinstance(field.target, ast.Name)
            and isinstance(text, ast.Expr)
            and isinstance(text.value, ast.Constant)
            and isinstance(text.value.value, str)
        ):
            found[field.target.id] = inspect.cleandoc(text.value.value)
    return found
