"""Measured attributes as terms of a query: colour and relative size. Each returns scores in [0, 1], one a group.

Knows the table of groups. Refuses to know the text encoder: a colour word is compared with what was measured.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import torch

from ..camera import Vec3
from ..color import BASIC, parse, rgb_to_lab
from .field import Group, LanguageField

COLOR_SPREAD = 14.0  # how far (Lab, lightness discounted) one colour word reaches before its neighbours take over
COLOR_LIMIT = 62.0  # farther than this it is not that colour, whatever the other names are
LIGHTNESS = 0.55  # names tolerate shading
DISTINCT = 20.0  # colour words closer than this to the asked one do not compete with it
COLOR_HOLDS = 0.35  # smallest score at which a colour word counts as true
PART_SHARE = 0.25  # a part this large may give its colour to the object ("the white lamp" by its shade)


def lab_of(word: str) -> Vec3:
    """CIE Lab of a colour word or hex value.

    Raises:
        UserError: unknown colour.
    """
    lightness, a, b = rgb_to_lab(torch.tensor(parse(word), dtype=torch.float64)).tolist()
    return (lightness, a, b)


def color_score(word: str, lab: Vec3) -> float:
    """How well a measured Lab value answers to a colour word, against the basic colour terms that compete with it."""
    asked = lab_of(word)
    distance = _distance(asked, lab)
    if distance > COLOR_LIMIT:
        return 0.0
    rivals = [r for r in _basic_labs() if _distance(asked, r) > DISTINCT]
    own = math.exp(-(distance**2) / (2 * COLOR_SPREAD**2))
    others = max((math.exp(-(_distance(r, lab) ** 2) / (2 * COLOR_SPREAD**2)) for r in rivals), default=0.0)
    return own / (own + others) if own + others > 1e-12 else float(distance < min(_distance(r, lab) for r in rivals))


def group_color_score(field: LanguageField, group: Group, word: str) -> float:
    """Colour score of a group: its own colour, or at a small discount that of a part that makes up much of it."""
    best = color_score(word, group.lab)
    for part in field.groups:
        if part.parent == group.id and part.count >= PART_SHARE * max(group.count, 1):
            best = max(best, 0.9 * color_score(word, part.lab))
    return best


def extent(group: Group, measure: str) -> float:
    """A group's size under the measure a size word speaks of, scene units (or cubed for small and large)."""
    width, depth, height = group.box.size
    if measure in ("tall", "short"):
        return height
    if measure in ("wide", "narrow"):
        return max(width, depth)
    return max(width, 1e-6) * max(depth, 1e-6) * max(height, 1e-6)


def size_scores(groups: Sequence[Group], word: str) -> list[float]:
    """Relative size among `groups`: 1 for those on the asked side of the widest gap in (log) size, 0 for the others.

    One group alone satisfies any size word; groups within 12 % of each other cannot be told apart by size.
    """
    if len(groups) < 2:
        return [1.0] * len(groups)
    sizes = [math.log(max(extent(g, word), 1e-12)) for g in groups]
    ordered = sorted(sizes)
    gap, low, high = max((b - a, a, b) for a, b in zip(ordered, ordered[1:], strict=False))
    if gap < math.log(1.12):
        return [1.0] * len(groups)
    border = (low + high) / 2
    wants_large = word in ("large", "tall", "wide")
    return [float((s > border) == wants_large) for s in sizes]


def _distance(x: Vec3, y: Vec3) -> float:
    return math.sqrt((LIGHTNESS * (x[0] - y[0])) ** 2 + (x[1] - y[1]) ** 2 + (x[2] - y[2]) ** 2)


def _basic_labs() -> list[Vec3]:
    if not _BASIC_LABS:
        _BASIC_LABS.extend(lab_of(value) for value in BASIC.values())
    return _BASIC_LABS


_BASIC_LABS: list[Vec3] = []
