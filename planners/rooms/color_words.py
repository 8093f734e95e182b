"""Lab values of colours as people write them in a scene graph: "dark oak", "navy", "tartan"."""

from __future__ import annotations

from functools import cache

import numpy as np
import torch

from ...gaussians.camera import Vec3
from ...gaussians.color import BASIC, FAMILIES, lab_to_rgb, plain_color, rgb_to_lab, shade_of
from ...gaussians.errors import UserError
from ...gaussians.language.query import attributes

_FAMILY = 0.7  # a "light blue" thing answers to "blue" at least this well, to any other basic word less
# Colour of a node whose colour is missing or unknown: no word fits this lightness (colour names compress chroma).
NO_COLOR: Vec3 = (1000.0, 0.0, 0.0)


def hex_of(lab: Vec3) -> str:
    """The colour nearest to Lab values that a display can show, as #rrggbb."""
    shown = (lab_to_rgb(torch.tensor(lab, dtype=torch.float64)).clamp(0, 1) * 255).round()
    return "#" + "".join(f"{int(c):02x}" for c in shown)


@cache
def color_of(name: str) -> Vec3:
    """Lab of a colour name in a graph: its own Lab, moved toward the basic colour word in it until that word fits best.

    The Lab of CSS names alone gives wrong words: light blue measures as teal, dark brown as red.
    """
    plain = plain_color(name)
    own, family = _lab(plain), _family(plain)
    if family is None or plain in BASIC:
        return own
    basic = _lab(family)
    if own == NO_COLOR:
        return basic
    for step in range(21):
        lab = np.array(own) + (np.array(basic) - np.array(own)) * step / 20
        if float(attributes.color_scores(family, lab)) >= _FAMILY:
            return _vec(lab)
    return basic


def _family(plain: str) -> str | None:
    """The basic colour word that a name ends with or belongs to."""
    last = plain.replace("-", " ").split()[-1:] or [""]
    return last[0] if last[0] in BASIC else FAMILIES.get(plain.replace(" ", "")) or FAMILIES.get(last[0])


def _lab(text: str) -> Vec3:
    try:
        return _vec(rgb_to_lab(torch.tensor(shade_of(text), dtype=torch.float64)).numpy())
    except UserError:
        return NO_COLOR


def _vec(values: np.ndarray) -> Vec3:
    x, y, z = (float(v) for v in values)
    return (x, y, z)
