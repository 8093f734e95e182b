"""The command line as a function, for tests of every verb."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any, NamedTuple

import pytest

from scenewright.agent import cli


class Answer(NamedTuple):
    """What one call of the command line leaves: exit code, standard output and standard error."""

    code: int
    out: str
    err: str

    @property
    def data(self) -> Any:
        return json.loads(self.out)

    @property
    def rows(self) -> list[Any]:
        return [json.loads(line) for line in self.out.splitlines()]


@pytest.fixture
def call(capsys: pytest.CaptureFixture[str]) -> Callable[..., Answer]:
    """Runs the command line with these arguments. An exit code that is no number counts as 1."""

    def run(*arguments: object) -> Answer:
        with pytest.raises(SystemExit) as exit_:
            cli.main([str(a) for a in arguments])
        streams = capsys.readouterr()
        code = exit_.value.code
        return Answer(code if isinstance(code, int) else 1, streams.out, streams.err)

    return run
