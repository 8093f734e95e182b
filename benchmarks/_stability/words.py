"""Rows of words: one instruction or question in ten voices, clauses in another order, typing errors, long texts."""

from __future__ import annotations

import json
import random
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from pathlib import Path
from statistics import fmean
from typing import Any

from ...agent.session.observation import GraphObservation
from ...gaussians.errors import ScenewrightError
from ...planners import load
from ...planners.plan import Planner
from ...planners.questions.asking import answer
from ...planners.questions.survey import Survey
from ...planners.rooms.plan_on_graph import resolve_text
from .. import _written
from .._rows import Level, Row
from .ground import Ground

FILE = Path(__file__).with_name("paraphrases.json")
SEED = 1609
_KEYS = ("qwertyuiop", "asdfghjkl", "zxcvbnm")
# Two clauses in both orders; each order must do the same to the same things.
CLAUSES = (
    ("delete the rug and paint the sofa red", "paint the sofa red and delete the rug"),
    ("move the mug onto the side table, then rotate the armchair on the right by 90 degrees",
     "rotate the armchair on the right by 90 degrees, then move the mug onto the side table"),
    ("delete the clock after painting the bookshelf black", "paint the bookshelf black, then delete the clock"),
    ("before you delete the vase, duplicate the mug", "duplicate the mug and then delete the vase"),
    ("paint the sofa and the rug white", "paint the rug and the sofa white"),
    ("make the floor lamp gold and twice as tall", "make the floor lamp twice as tall and gold"),
    ("on the side table put the mug", "put the mug on the side table"),
    ("next to the sofa, add a plant", "add a plant next to the sofa"),
    ("by 45 degrees rotate the coffee table", "rotate the coffee table by 45 degrees"),
    ("with a mirror, replace the clock", "replace the clock with a mirror"),
    ("50 cm to the left, move the sofa", "move the sofa 50 cm to the left"),
    ("red, please, the bookshelf", "make the bookshelf red please"),
)  # fmt: skip
# One length or number in several spellings; each must mean the first.
SPELLINGS = (
    ("move the sofa 0.5 m to the left", "move the sofa half a metre to the left", "move the sofa 50 cm to the left",
     "move the sofa 50cm left", "move the sofa to the left by 500 mm", "move the sofa fifty centimeters to the left",
     "move the sofa half a meter left", "move the sofa 0,5 m to the left"),
    ("rotate the sofa by 90 degrees", "rotate the sofa by ninety degrees", "rotate the sofa 90°",
     "rotate the sofa a quarter turn", "give the sofa a quarter turn", "rotate the sofa by 90 deg"),
    ("make the rug 1.5 times larger", "make the rug 50% larger", "scale the rug by 1.5", "scale the rug to 150 %",
     "make the rug one and a half times larger", "enlarge the rug by 50 percent"),
    ("delete two cushions", "delete 2 cushions", "delete a couple of cushions", "delete a pair of cushions"),
    ("duplicate the vase three times", "make three copies of the vase", "duplicate the vase 3 times",
     "duplicate the vase 3x", "make 3 duplicates of the vase"),
)  # fmt: skip
# Signs and spaces around the same words.
SIGNS: tuple[tuple[str, Callable[[str], str]], ...] = (
    ("capitals", str.upper),
    ("no capitals, a full stop", lambda t: t.lower() + "."),
    ("exclamations", lambda t: t + "!!!"),
    ("double spaces", lambda t: t.replace(" ", "  ")),
    ("no-break spaces", lambda t: t.replace(" ", "\u00a0")),
    ("quotes", lambda t: f"\u201c{t}\u201d"),
    ("full width", lambda t: "".join(chr(ord(c) + 0xFEE0) if "!" <= c <= "~" else c for c in t)),
    ("emoji", lambda t: t + " \U0001f642"),
    ("markdown", lambda t: f"**{t}**"),
)


def rows(ground: Ground) -> Iterator[Row]:
    """All of them."""
    said = _said()
    yield from _voices("words.edits", said["edits"], said["voices"], _edit)
    yield from _voices("words.questions", said["questions"], said["voices"], _question)
    yield _alike("words.order_of_clauses", [("in another order", pair) for pair in CLAUSES])
    yield _alike("words.numbers", [("spelt otherwise", (other, plain)) for plain, *rest in SPELLINGS for other in rest])
    plain = [edit[0] for edit in said["edits"]]
    signs = [(name, (change(text), text)) for name, change in SIGNS for text in plain]
    yield _alike("words.signs", signs)
    typed = [
        (f"{count} letters", (mistyped(text, count, seed), text))
        for count in (1, 2, 3)
        for text in plain
        for seed in range(2 if ground.quick else 6)
    ]
    yield _alike("words.typing_errors", typed)
    yield _long(plain)


@cache
def _said() -> dict[str, Any]:
    loaded: dict[str, Any] = json.loads(FILE.read_text(encoding="utf-8"))
    return loaded


@cache
def _grammar() -> Planner:
    return load("auto")


@cache
def _edit(text: str) -> str:
    """What an instruction would do, on which things, or its verdict; as text that can be compared."""
    room = _written.stage(_said()["room"])
    try:
        found = resolve_text(room, _grammar(), text, None, GraphObservation(room))
    except ScenewrightError as error:
        return f"refused: {error}"
    if found.verdict != "ok":  # two that are not understood do not agree
        return f"{found.verdict} {sorted(map(str, found.candidates)) if found.candidates else text}"
    steps = sorted(json.dumps(one, sort_keys=True) for step in found.steps for one in _each(_written.described(step)))
    return "; ".join(steps)


def _each(step: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """A step for each of its targets, with numbers of a few digits."""
    rounded = {k: round(v, 4) if isinstance(v, float) else v for k, v in step.items()}
    for target in step["targets"] or [None]:
        yield {**rounded, "targets": target}


@cache
def _question(text: str) -> str:
    """The answer to a question, or that there is none."""
    graph = _written.stage(_said()["room"]).graph
    try:
        given = answer(text, Survey.of_graph(graph))
    except ScenewrightError as error:
        return f"refused: {error}"
    return f"none: {text}" if given.answer is None else repr(given.answer)


def _voices(
    name: str, said: Sequence[Sequence[str]], voices: Sequence[str], means: Callable[[str], str]
) -> Iterator[Row]:
    """Share of instructions that mean the same in each voice, the clearest voice first."""
    shares = []
    for i, voice in enumerate(voices, start=1):
        shares.append((voice, fmean(means(line[i]) == means(line[0]) for line in said)))
    shares.sort(key=lambda pair: -pair[1])
    levels = tuple(Level(voice, share) for voice, share in shares)
    yield Row(name, 1.0, levels, "share the same", len(said) * len(voices))


def _alike(name: str, pairs: Sequence[tuple[str, tuple[str, str]]]) -> Row:
    """Share of texts that mean what another means, by level."""
    labels = list(dict.fromkeys(label for label, _ in pairs))
    levels = tuple(
        Level(label, fmean(_edit(a) == _edit(b) for own, (a, b) in pairs if own == label)) for label in labels
    )
    return Row(name, 1.0, levels, "share the same", len(pairs))


def _beside(letter: str) -> str:
    """The letters on the keys beside a letter's, in its row."""
    row = next((row for row in _KEYS if letter in row), letter)
    at = row.index(letter)
    return row[max(at - 1, 0) : at] + row[at + 1 : at + 2] or letter


def mistyped(text: str, count: int, seed: int) -> str:
    """The text with some words mistyped: a letter left out, doubled, exchanged with its neighbour, or one key aside."""
    chance = random.Random(f"{SEED} {text} {seed}")
    words = text.split()
    long = [i for i, word in enumerate(words) if len(word) >= 4 and word.isalpha()]
    for i in chance.sample(long, min(count, len(long))):
        word, at = words[i], chance.randrange(1, len(words[i]) - 1)
        words[i] = chance.choice((
            word[:at] + word[at + 1 :],
            word[:at] + word[at] + word[at:],
            word[:at] + word[at + 1] + word[at] + word[at + 2 :],
            word[:at] + chance.choice(_beside(word[at])) + word[at + 1 :],
        ))  # fmt: skip
    return " ".join(words)


def _long(plain: Sequence[str]) -> Row:
    """Many instructions in one sentence: the share of texts all of whose steps come out, by the number of clauses."""
    order = list(plain)
    values = []
    for count in (2, 4, 8):
        good = []
        for seed in range(6):
            texts = random.Random(SEED + seed).sample([t for t in order if " and " not in t], count)
            found = _edit(", ".join(texts[:-1]) + " and " + texts[-1])
            wanted = "; ".join(sorted(step for t in texts for step in _edit(t).split("; ")))
            good.append(found == wanted)
        values.append(Level(f"{count} clauses", fmean(good)))
    return Row("words.long_instructions", 1.0, tuple(values), "share the same", 18)


def failures() -> list[str]:
    """What does not mean the same, for whoever mends it."""
    said = _said()
    lines = []
    for key, means in (("edits", _edit), ("questions", _question)):
        lines += [
            f"{voice}: {text!r}: {means(text)} | wanted {means(line[0])}"
            for line in said[key]
            for voice, text in zip(said["voices"], line[1:], strict=True)
            if means(text) != means(line[0])
        ]
    return lines
