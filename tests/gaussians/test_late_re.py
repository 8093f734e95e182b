"""Patterns that wait until they are used are the same patterns, and all that readers of words hold can be compiled."""

from __future__ import annotations

import copy
import importlib
import pickle
import pkgutil
import re
from collections.abc import Iterator

import pytest

from scenewright import planners
from scenewright.gaussians import late_re


def test_a_pattern_is_compiled_when_it_is_first_used() -> None:
    broken = late_re.compile("(")
    with pytest.raises(re.error, match="unterminated"):
        broken.search("x")


def test_it_finds_what_the_pattern_finds() -> None:
    late, plain = late_re.compile(r"(?P<n>\d+) ?(m)\b", re.I), re.compile(r"(?P<n>\d+) ?(m)\b", re.I)
    said = "2 M and 35m"
    assert [m.groupdict() for m in late.finditer(said)] == [m.groupdict() for m in plain.finditer(said)]
    assert late.sub(r"\g<n> metres", said) == plain.sub(r"\g<n> metres", said) == "2 metres and 35 metres"
    assert (late.pattern, late.flags, late.groups) == (plain.pattern, plain.flags, plain.groups)
    assert late.search is late.search  # nothing stands between a caller and the pattern any more
    for other in (copy.copy(late), copy.deepcopy(late), pickle.loads(pickle.dumps(late))):
        assert other.search(said) is not None


def _held(value: object) -> Iterator[late_re.LatePattern]:
    """The patterns in a value of a module: alone, or in tables of tables."""
    if isinstance(value, late_re.LatePattern):
        yield value
    elif isinstance(value, dict):
        yield from _held((*value, *value.values()))
    elif isinstance(value, tuple | list):
        for part in value:
            yield from _held(part)


def test_all_patterns_of_readers_can_be_compiled() -> None:
    count = 0
    for folder in ("grammar", "questions"):
        package = importlib.import_module(f"{planners.__name__}.{folder}")
        for info in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            for pattern in _held(tuple(vars(importlib.import_module(info.name)).values())):
                assert pattern.groups >= 0, info.name
                count += 1
    assert count > 300  # they were found
