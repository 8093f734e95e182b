"""Measured attributes as terms of a query: colour and relative size. Each returns scores in [0, 1], one a group.

Knows the table of groups. Refuses to know the text encoder: a colour word is compared with what was measured.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache
from itertools import pairwise

import numpy as np
import torch
from numpy.typing import NDArray

from ...color import BASIC, naming_space, parse, rgb_to_lab, shade_of
from ..field.language_field import Group, LanguageField

F64 = NDArray[np.float64]

COLOR_SPREAD = 9.0  # how far (naming space) one colour word reaches before its neighbours take over
COLOR_LIMIT = 36.0  # farther than this it is not that colour, whatever the other names are
NEUTRAL = 9.0  # chroma below which a colour word means black, gray or white
DISTINCT = 9.0  # colour words closer than this to the asked one do not compete with it
COLOR_HOLDS = 0.3  # smallest score at which a colour word counts as true: in 24 rooms 95 % of things answer to their
# clear colour and 0.3 % to a clearly different one; at 0.4 it is 90 % and 0.3 %
PART_DISCOUNT = 0.9  # the whole thing's colour comes before that of one of its parts
PART_SHARE = 0.25  # a part this large may give its colour to the object ("the white lamp" by its shade)
HUE_SHARE = 0.5  # of all the chroma of a thing, from which a colour is its hue ("the red bicycle", black tyres and all)


def color_scores(word: str, lab: NDArray[np.floating]) -> F64:
    """How well measured Lab values `[..., 3]` answer to a colour word, against the basic terms that compete; `[...]`.

    Raises:
        UserError: unknown colour.
    """
    asked, rivals = _terms(word)
    here = naming_space(torch.from_numpy(np.asarray(lab, dtype=np.float64))).numpy()
    distance = np.linalg.norm(here - asked, axis=-1)
    others = np.linalg.norm(here[..., None, :] - rivals, axis=-1).min(axis=-1)
    share = 1 / (1 + np.exp(np.clip((distance**2 - others**2) / (2 * COLOR_SPREAD**2), -50, 50)))
    return np.where(distance > COLOR_LIMIT, 0.0, share)


@cache
def _terms(word: str) -> tuple[F64, F64]:
    """The asked colour `[3]` and the basic terms that compete with it `[R, 3]`, in naming space."""
    asked = naming_space(rgb_to_lab(torch.tensor(shade_of(word), dtype=torch.float64))).numpy()
    basic = naming_space(rgb_to_lab(torch.tensor([shade_of(v) for v in BASIC], dtype=torch.float64))).numpy()
    return asked, basic[np.linalg.norm(basic - asked, axis=1) > DISTINCT]


def group_color_scores(field: LanguageField, word: str) -> F64:
    """`[G]` colour score of every group: its own, or at a small discount that of a part that makes up much of it.

    Raises:
        UserError: unknown colour.
    """
    own = color_scores(word, field.labs)
    best = own.copy()
    for owner, parts in field.parts.items():
        for part in parts:
            if field.groups[part].count >= PART_SHARE * max(field.groups[owner].count, 1):
                best[owner] = max(best[owner], PART_DISCOUNT * own[part])
    return best


def hue_shares(field: LanguageField, word: str) -> F64:
    """`[G]` how much of all the chroma of a group's parts, weighted by their counts, is of parts that answer to a
    colour word: black tyres and white spokes have none to speak of. Zero for black, gray and white.

    Raises:
        UserError: unknown colour.
    """
    shares = np.zeros(len(field.groups))
    if float(np.linalg.norm(rgb_to_lab(torch.tensor(parse(word), dtype=torch.float64))[1:])) < NEUTRAL:
        return shares
    fits = color_scores(word, field.labs) >= COLOR_HOLDS
    chroma = np.linalg.norm(field.labs[:, 1:], axis=1) * np.array([g.count for g in field.groups])
    for group in field.groups:
        parts = list(field.parts.get(group.id, (group.id,)))
        shares[group.id] = chroma[parts][fits[parts]].sum() / max(float(chroma[parts].sum()), 1e-9)
    return shares


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
    gap, low, high = max((b - a, a, b) for a, b in pairwise(ordered))
    if gap < math.log(1.12):
        return [1.0] * len(groups)
    border = (low + high) / 2
    wants_large = word in ("large", "tall", "wide")
    return [float((s > border) == wants_large) for s in sizes]
