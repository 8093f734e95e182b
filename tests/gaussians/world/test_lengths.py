"""Units of length: every spelling, and no second table of them."""

from __future__ import annotations

import re
from pathlib import Path
from typing import get_args

import pytest

import scenewright
from scenewright.gaussians.world.lengths import IN_METRES, METRES, SQUARE_METRES, UNITS, Unit, in_metres
from scenewright.planners.compose.sentence import amounts
from scenewright.planners.grammar.vocabulary import quantities


def test_every_unit_has_spellings_and_a_length() -> None:
    assert set(UNITS.values()) == set(get_args(Unit)) == {*METRES, "units"}
    assert in_metres(3, "units") == 3


@pytest.mark.parametrize("said", [*UNITS, *IN_METRES])
def test_every_spelling_is_read_behind_a_number(said: str) -> None:
    read = quantities.read(("3", said))
    assert read is not None
    assert (read.kind, read.taken) == ("LENGTH", 2)
    assert in_metres(read.value, read.unit) == pytest.approx(
        3 * IN_METRES.get(said, METRES.get(UNITS.get(said, ""), 1))
    )


@pytest.mark.parametrize("said", SQUARE_METRES)
def test_every_area_is_read(said: str) -> None:
    read = amounts.read(("20", *said.split()))
    assert read is not None
    assert read.sides == {"area": 20 * SQUARE_METRES[said]}


def test_no_other_module_defines_an_inch_or_a_foot() -> None:
    package = Path(scenewright.__file__).parent
    folders = [package / name for name in ("gaussians", "tools", "planners", "agent")]
    sources = [p for folder in folders for p in folder.resolve().rglob("*.py") if p.name != "lengths.py"]
    assert len(sources) > 300
    assert not [str(p) for p in sources if re.search(r"\b0\.(?:0254|3048|9144)\b", p.read_text("utf-8"))]
