"""Builds rooms for queries whose answer is known from the placement of their things."""

from __future__ import annotations

import zlib
from collections.abc import Sequence

import numpy as np
import torch
from numpy.typing import NDArray

from ...gaussians.assets import Asset
from ...gaussians.assets.furnishing.furnish import assemble
from ...gaussians.assets.furnishing.layout import Layout
from ...gaussians.color import BASIC, parse, rgb_to_lab
from ...gaussians.world.box import YawBox
from .cases import Case, case_of

SIZE = (6.0, 5.4, 2.6)  # metres
APART = 0.22  # metres around a thing that stands for itself
CLEARANCE = 0.015  # metres around a thing under or inside another
ALIKE = 25.0  # CIE 1976 difference up to which a paint is still its colour term: grain, seams and glaze vary it
DETAIL = 0.6  # of floor and walls: nothing is asked of them


def bare(name: str, seed: int) -> Layout:
    """An empty room with three walls; `name` keeps the chances of different sets apart."""
    return Layout(*SIZE, ("north", "west", "east"), np.random.default_rng([zlib.crc32(name.encode()), seed]))


def stand(layout: Layout, things: Sequence[Asset]) -> list[int | None]:
    """Each on a free spot of the floor, turned at random; None for those that found none. Large things go first."""
    order = sorted(range(len(things)), key=lambda i: (-things[i].size[0] * things[i].size[1], i))
    spots: dict[int, int | None] = {i: layout.anywhere(things[i], APART, edge=False) for i in order}
    return [spots[i] for i in range(len(things))]


def beneath(layout: Layout, thing: Asset, anchor: int) -> int | None:
    """On the floor below the anchor's top where its Gaussians leave room; None if they do not."""
    return _within(layout, thing, anchor, 0.0)


def within(layout: Layout, thing: Asset, anchor: int) -> int | None:
    """On the bottom of a hollow anchor; None if there is no room."""
    return _within(layout, thing, anchor, 0.02)


def _within(layout: Layout, thing: Asset, anchor: int, above: float) -> int | None:
    base, means = layout.things[anchor].box, layout.things[anchor].asset.cloud.means.numpy()
    w, d, h = thing.size
    if h > base.h:
        return None
    spread = np.linspace(-0.25, 0.25, 5)
    for right in sorted(spread * base.w, key=abs):
        for back in sorted(spread * base.d, key=abs):
            reach = max(w, d) / 2 + CLEARANCE  # it may be turned
            near = (np.abs(means[:, :2] - [right, back]) < reach).all(axis=1)
            if not (near & (means[:, 2] > above) & (means[:, 2] < above + h + CLEARANCE)).any():
                x, y = base.world(float(right), float(back))
                return layout.put(
                    thing, YawBox(x, y, base.low + above, w, d, h, base.yaw), anchor if above else "floor"
                )
    return None


def over(layout: Layout, thing: Asset, x: float, y: float) -> int:
    """Hanging from the ceiling above a spot."""
    w, d, h = thing.size
    return layout.put(thing, YawBox(x, y, layout.h - h, w, d, h), "ceiling")


def built(layout: Layout, seed: int) -> Case:
    """The room as a case, not embedded."""
    return case_of(assemble(layout, "staged", layout.rng, DETAIL, False), seed)


def share_of(asset: Asset, color: str) -> float:
    """Share of an asset's surface whose paint, without light, is within `ALIKE` of a basic colour term's shade."""
    scales: NDArray[np.float32] = asset.cloud.scales.numpy()
    area = scales[:, 0] * scales[:, 1]
    paint = rgb_to_lab(torch.from_numpy(asset.unlit.albedo))
    asked = rgb_to_lab(torch.tensor(parse(BASIC[color]), dtype=paint.dtype))
    near = ((paint - asked).norm(dim=1) < ALIKE).numpy()
    return float(area[near].sum() / area.sum())
