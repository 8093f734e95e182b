"""A real browser for tests that are marked `browser`; where there is none, they are skipped with the reason."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from typing import Any

import pytest

from scenewright.benchmarks._view.browser import chromium
from scenewright.gaussians.errors import BackendError


@contextmanager
def browser_or_skip() -> Iterator[Any]:
    """A browser, closed at the end of the block."""
    with ExitStack() as stack:
        try:
            opened = stack.enter_context(chromium())
        except BackendError as error:
            pytest.skip(str(error))
        yield opened
