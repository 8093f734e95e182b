"""Questions about the six moving rooms in many words, with the answers that the rooms were made to give.

`motion_paraphrases.tsv` holds a room, what is expected and the question; the questions were written before the reader
that is developed with them, by somebody who knew it: a test of what stays, no measure of what it does for others.
Behind them stand questions of five people who knew no code, from which the reader has learned since.
"""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Any

import pytest

from scenewright.benchmarks._motion.asking import asked

CASES = Path(__file__).with_name("motion_paraphrases.tsv")
RIGHT, WRONG = 0.9, 0.02
NEAR = 0.15  # seconds, unless said otherwise


def expected(said: str) -> dict[str, Any]:
    """ "s 3.5 .1", "n 30 3 cm", "y yes", "names a,b", "order a;b", "place wall" or "refuse" as the judge takes it."""
    kind, _, rest = said.partition(" ")
    fields = rest.split()
    if kind in ("s", "n"):
        tolerance = float(fields[1]) if len(fields) > 1 else NEAR
        unit = {"unit": fields[2]} if len(fields) > 2 else {}
        told = "seconds" if kind == "s" else "number"
        return {"kind": told, "value": float(fields[0]), "tolerance": tolerance, **unit}
    value = {"y": rest == "yes", "names": rest.split(","), "order": rest.split(";"), "place": rest, "refuse": None}
    return {"kind": "yesno" if kind == "y" else kind, "value": value[kind]}


@pytest.mark.slow
def test_paraphrases_are_answered() -> None:
    rows = [line.split("\t") for line in CASES.read_text().splitlines()]
    found = asked([{"room": room, "expect": expected(said), "text": text} for room, said, text in rows])
    counts = Counter(a.outcome for a in found)
    failed = [(a.outcome, a.case["text"], a.answer.text) for a in found if a.outcome != "right"]
    assert counts["right"] >= RIGHT * len(found) and counts["wrong"] <= WRONG * len(found), failed
