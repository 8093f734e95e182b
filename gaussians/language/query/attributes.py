"""Measured attributes as terms of a query: colour and relative size, with a score in [0, 1] for each group.

Colour words are compared with measured colours; they never go to the text encoder.
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

COLOR_SPREAD = 9.0  # in naming space: width of the transition between neighbouring colour words
COLOR_LIMIT = 36.0  # distance from which a colour does not match, whatever the other terms are
NEUTRAL = 9.0  # chroma below which a colour word means black, gray or white
DISTINCT = 9.0  # basic terms closer than this to the given word do not compete with it
COLOR_HOLDS = 0.3  # score from which a colour word matches: in 24 rooms 95 % of things match their clear colour and
# 0.3 % a clearly different one; at 0.4 it is 90 % and 0.3 %
PART_DISCOUNT = 0.9  # factor of the score of a part, so that the colour of the whole object takes precedence
PART_SHARE = 0.25  # share of an object from which the colour of a part counts ("the white lamp" by its shade)
HUE_SHARE = 0.5  # share of the chroma of an object from which a colour is its hue (a red bicycle with black tyres)


def color_scores(word: str, lab: NDArray[np.floating]) -> F64:
    """Score `[...]` of a colour word for Lab values `[..., 3]`, in competition with the basic colour terms.

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
    """The colour of a word `[3]` and of the basic terms that compete with it `[R, 3]`, in naming space."""
    asked = naming_space(rgb_to_lab(torch.tensor(shade_of(word), dtype=torch.float64))).numpy()
    basic = naming_space(rgb_to_lab(torch.tensor([shade_of(v) for v in BASIC], dtype=torch.float64))).numpy()
    return asked, basic[np.linalg.norm(basic - asked, axis=1) > DISTINCT]


def group_color_scores(field: LanguageField, word: str) -> F64:
    """Colour score `[G]` of every group: its own, or that of a large part with a small discount.

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
    """Share `[G]` of each group's chroma, weighted by counts, that lies in parts matching a colour word.

    Black tyres and white spokes contribute almost no chroma. It is zero for the words black, gray and white.

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
    """Size of a group in the measure of a size word, scene units (cubed for small and large)."""
    width, depth, height = group.box.size
    if measure in ("tall", "short"):
        return height
    if measure in ("wide", "narrow"):
        return max(width, depth)
    return max(width, 1e-6) * max(depth, 1e-6) * max(height, 1e-6)


def size_scores(groups: Sequence[Group], word: str) -> list[float]:
    """Relative size among `groups`: 1 on the side of the word of the widest gap in log size, 0 on the other.

    A single group matches any size word; sizes within 12 % of each other are not distinguished, so all match.
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
