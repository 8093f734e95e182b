"""Lamps and windows of a scene as sources of light, and the shade of a lamp that is lit or goes out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import torch
from torch import Tensor

from ...gaussians.cloud import GaussianCloud
from ...gaussians.harmonics import SH_C0, dc_to_color
from ...gaussians.language.field.group_index import index_groups
from ...gaussians.language.field.language_field import Group
from ...gaussians.scene import Scene
from ...gaussians.world import kinds
from ...gaussians.world.words import singular
from .space import Source
from .whites import white

SURE = 0.5  # probability of its name from which a thing counts as a lamp or a window without being named
_BULB = 3400.0  # kelvins of a bulb as an eye that is half adapted sees it
_FLAME = 3000.0  # kelvins below which a source is a flame
_SHOWN = 0.42  # of the light of a bulb, that its shade adds to its own colour
_STRETCH = 0.02  # quantile of the heights of a thing at which it ends
_SLICES, _POLE = 16, 0.5  # of a lamp's height, and its width relative to the widest below which it is a pole
_OFF = 0.45  # share of its brightness that a shade keeps at least when the lamp goes out
_INWARD = 0.25  # metres before the pane where a window's light starts
_WIDE = 0.7  # metres: half the width of a window


@dataclass(frozen=True)
class _Bulb:
    """How a kind of lamp shines: strength at a metre, colour in kelvins, and the part of its height that is lit."""

    strength: float
    kelvin: float = _BULB
    low: float = 0.6
    high: float = 1.0


_BULBS: dict[str, _Bulb] = {
    "floor lamp": _Bulb(1.0, low=0.72), "arc lamp": _Bulb(1.0, low=0.72), "table lamp": _Bulb(0.7, low=0.45),
    "desk lamp": _Bulb(0.6, low=0.6), "pendant lamp": _Bulb(1.2, low=0.0, high=0.6),
    "chandelier": _Bulb(1.6, low=0.0, high=0.7), "string lights": _Bulb(0.5, low=0.0),
    "lantern": _Bulb(0.3, 2900.0, 0.1, 0.7), "paper lantern": _Bulb(0.6, low=0.0), "candle": _Bulb(0.22, 2700.0, 0.7),
    "fireplace": _Bulb(0.8, 2600.0, 0.05, 0.5),
}  # fmt: skip
_ANY = _Bulb(0.7, low=0.45)


@cache
def lamp_kind(label: str) -> str | None:
    """The kind of lamp that a label names, None if it names no lamp; "lamp" and "light" are any lamp."""
    kind = kinds.of(label)
    if kind is not None:
        return kind.name if kind.name in _BULBS else None
    last = singular(label.split()[-1]) if label.split() else ""
    return (
        "lamp" if last in ("lamp", "light", "chandelier", "lantern", "candle", "sconce", "spotlight", "bulb") else None
    )


@dataclass(frozen=True, eq=False)
class Lamp:
    """A lamp that is lit or put out.

    Attributes:
        source: its light.
        shade: `[M]` int64 rows of the cloud that glow themselves.
        flame: whether it burns.
    """

    source: Source
    shade: Tensor
    flame: bool = False

    def times(self, amount: float) -> Lamp:
        """The lamp `amount` times as strong."""
        return replace(self, source=replace(self.source, strength=amount * self.source.strength))


def lamp_of(scene: Scene, rows: Tensor, label: str, group: int, unit: float) -> Lamp | None:
    """A thing as a lamp; None if nothing of it is solid.

    Args:
        rows: `[M]` int64 of the thing.
        label: its name.
        group: its group.
        unit: metres per scene unit.
    """
    rows = rows[scene.cloud.opacities[rows] > 0.1]
    if not len(rows):
        return None
    bulb = _BULBS.get(lamp_kind(label) or "", _ANY)
    points = scene.cloud.means[rows].cpu()
    lit = _shade(points, torch.tensor(scene.frame.up, dtype=torch.float32), bulb)
    place = points[lit].median(dim=0).values.double()
    spread = float(torch.linalg.vector_norm(points[lit].double() - place, dim=1).median())
    source = Source(_vec(place), bulb.strength, bulb.kelvin, max(0.12, spread * unit), group)
    return Lamp(source, rows[lit], bulb.kelvin < _FLAME)


def _shade(points: Tensor, up: Tensor, bulb: _Bulb) -> Tensor:
    """`[M]` bool: which of the points `[M, 3]` of a lamp belong to what glows: the part of its height that does,
    without a pole, which is thinner than half of the widest place there."""
    heights = points @ up
    ends = heights.quantile(torch.tensor([_STRETCH, 1 - _STRETCH])) if len(points) > 4 else heights.aminmax()
    part = (heights - ends[0]) / (ends[1] - ends[0]).clamp(min=1e-9)
    lit = (part >= bulb.low) & (part <= (bulb.high if bulb.high < 1 else np.inf))
    if not bool(lit.any()):
        return torch.ones_like(lit)
    level = points - heights[:, None] * up
    away = torch.linalg.vector_norm(level - level[lit].median(dim=0).values, dim=1)
    slice_of = (part * _SLICES).long().clamp(0, _SLICES - 1)
    slices = [away[slice_of == i] for i in range(_SLICES)]
    wide = torch.tensor([float(s.quantile(0.8)) if len(s) else 0.0 for s in slices])
    widest = float(wide[slice_of[lit]].max())
    return lit & (wide[slice_of] >= _POLE * widest)


def lamps_in(scene: Scene, unit: float) -> list[Lamp]:
    """The lamps of a scene whose names are sure; none without a language field."""
    found = []
    for group in _named(scene):
        if lamp_kind(group.label) is not None:
            rows = torch.from_numpy(index_groups(scene.cloud).rows(scene.language.leaves(group.id)))  # type: ignore[union-attr]
            lamp = lamp_of(scene, rows, group.label, group.id, unit)
            found += [lamp] if lamp is not None else []
    return found


def windows_in(scene: Scene, unit: float, strength: float, kelvin: float) -> list[Source]:
    """The windows of a scene as sources, each of a strength at a metre."""
    if not len(scene.cloud):
        return []
    step = max(1, len(scene.cloud) // 4096)
    middle = scene.cloud.means[::step].median(dim=0).values.double().cpu().numpy()
    found = []
    for group in _named(scene):
        kind = kinds.of(group.label)
        if kind is None or kind.name != "window":
            continue
        center, axes = np.array(group.box.center), np.array(group.box.axes)
        thin = axes[int(np.argmin(group.box.size[:2]))]
        inward = thin * np.sign(thin @ (middle - center) or 1.0)
        place = center + inward * _INWARD / unit
        found.append(Source(_vec(torch.from_numpy(place)), strength, kelvin, _WIDE, group.id))
    return found


def _named(scene: Scene) -> list[Group]:
    """The things of a scene whose names are sure."""
    field = scene.language
    return [] if field is None else [g for g in field.objects() if g.count and g.label_score > SURE]


def glowing(cloud: GaussianCloud, lamps: Sequence[Lamp], on: bool) -> GaussianCloud:
    """The cloud with the shades of lamps lit, or gone out: what a lit shade adds is `1 - (1 - c)(1 - glow)` in each
    channel, and going out takes the same away."""
    if not lamps:
        return cloud
    sh = cloud.sh.clone()
    for lamp in lamps:
        tint = white(lamp.source.kelvin)
        glow = torch.tensor(_SHOWN * (tint / tint.max()) ** (1 / 2.2), dtype=torch.float32)
        was = dc_to_color(cloud.sh[lamp.shade, 0])
        now = was * (1 - glow) + glow if on else ((was - glow) / (1 - glow)).maximum(_OFF * was)
        factor = (1 - glow).expand_as(was) if on else now / was.clamp(min=1e-3)
        sh[lamp.shade] = cloud.sh[lamp.shade] * factor[:, None].clamp(max=4.0)
        sh[lamp.shade, 0] = (now - 0.5) / SH_C0
    return cloud.replace(sh=sh)


def _vec(values: Tensor) -> tuple[float, float, float]:
    x, y, z = (float(v) for v in values)
    return x, y, z
