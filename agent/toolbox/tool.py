"""`Tool`, one function that agents call, and `Desk`, what tools work on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar

from pydantic import ValidationError

from ..session.session import Session
from .folder import Folder
from .limits import Arguments, complaint
from .reply import Reply
from .schemas import argument_schema


@dataclass(frozen=True)
class Hints:
    """What a tool does to the scene and to files, as tool servers tell their clients.

    Attributes:
        read_only: it changes neither the scene nor files.
        destructive: it may remove or overwrite something. Edits of the scene can be undone, and are called destructive
            where they remove things.
        idempotent: calling it again with the same arguments changes nothing more.
    """

    read_only: bool = False
    destructive: bool = False
    idempotent: bool = False


READS = Hints(read_only=True, idempotent=True)


@dataclass(frozen=True, eq=False)
class Desk:
    """What tools work on.

    Attributes:
        session: the session.
        folder: the only folder that is written to; None writes nothing.
        keep_field: write the language field beside a saved scene.
    """

    session: Session
    folder: Folder | None = None
    keep_field: bool = False


@dataclass(frozen=True, eq=False)
class Tool:
    """One function.

    Attributes:
        name: lower-case letters and underscores.
        description: what it does, for a language model.
        schema: JSON Schema of its arguments, an object.
        run: does it; the arguments are checked there. Raises ScenewrightError, and then nothing was changed.
        hints: what it does to the scene and to files.
        needs_field: whether it looks for things, for which the scene must be embedded.
    """

    name: str
    description: str
    schema: dict[str, Any]
    run: Callable[[Desk, dict[str, Any]], Reply]
    hints: Hints = Hints()
    needs_field: bool = True


A = TypeVar("A", bound=Arguments)


def tool(
    name: str, arguments: type[A], hints: Hints, work: Callable[[Desk, A], Reply], *, needs_field: bool = True
) -> Tool:
    """A tool whose arguments are a model; the docstring of `work` is its description."""

    def run(desk: Desk, given: dict[str, Any]) -> Reply:
        try:
            said = arguments.model_validate(given)
        except ValidationError as error:
            raise complaint(error, name) from error
        return work(desk, said)

    return Tool(name, " ".join((work.__doc__ or "").split()), argument_schema(arguments), run, hints, needs_field)
