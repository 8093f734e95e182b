"""A scene under another light: the change everywhere, what comes from a side, and what lamps and windows add."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import torch
from torch import Tensor

from ...gaussians.scene import Scene
from .lamps import Lamp, glowing
from .light import Light, Tone, colors_of, mean_luminance, relit, tone_of, toned
from .space import Sky, Source, Space
from .whites import NEUTRAL

_SAMPLE = 1 << 14


@dataclass(frozen=True, eq=False)
class Relighting:
    """What happens to the light of a scene.

    Attributes:
        light: the change of what is there, the same everywhere.
        kelvin: the white point that it ends with, relative to which lamps are coloured.
        sky: the side from which what is there comes, None for no change.
        lit: lamps that are lit.
        out: lamps that go out.
        windows: windows that let light in.
    """

    light: Light = field(default_factory=Light)
    kelvin: float = NEUTRAL
    sky: Sky | None = None
    lit: tuple[Lamp, ...] = ()
    out: tuple[Lamp, ...] = ()
    windows: tuple[Source, ...] = ()

    @property
    def local(self) -> bool:
        """Whether places differ."""
        return bool(self.sky or self.lit or self.out or self.windows)


@dataclass(frozen=True)
class Measured:
    """Mean luminance of a sample of the surfaces, weighted by visible area: before, with the change that is the same
    everywhere, and with lamps and windows; and the share that is rolled off."""

    before: float
    even: float
    after: float
    rolled: float


def relighted(scene: Scene, rows: Tensor | None, asked: Relighting, unit: float) -> tuple[Scene, Measured]:
    """The scene with some rows `[M]` of its cloud under another light, all by default, and what was measured.

    Only harmonics change, and only those of the rows and of the shades of lamps; the language field is left.

    Args:
        unit: metres per scene unit.
    """
    cloud = scene.cloud
    chosen = torch.arange(len(cloud)) if rows is None else rows.cpu()
    few = chosen[:: max(1, -(-len(chosen) // _SAMPLE))]
    colors = colors_of(cloud, few)
    sources, space = _sources(asked), None
    even: Tensor | None = None
    if asked.local:
        owners = [s.owner for s in sources if s.owner >= 0]
        space = Space.of(scene, unit, owners)
        even = space.received(scene, few, (), asked.sky) if asked.sky is not None else None
    tone = tone_of(asked.light, colors, even)
    received = None
    if space is not None:
        received = space.received(scene, chosen, sources, asked.sky, asked.kelvin)
    was = colors.rgb.clamp(0, 1)
    before = mean_luminance(was, colors.weight)
    now = toned(was, asked.light.matrix, tone, even)
    free = toned(was, asked.light.matrix, tone, even, knee=1e9)
    rolled = float(colors.weight[((free.amax(dim=1) > 1) & (was.amax(dim=1) < 1)).to(colors.weight.device)].sum())
    if not (asked.light.changes or asked.local):
        return scene, Measured(before, before, before, 0.0)
    dark = glowing(cloud, asked.out, on=False)
    after = relit(dark, None if rows is None else chosen, asked.light.matrix, tone, received)
    after = glowing(after, asked.lit, on=True)
    shown = colors_of(after, few)
    measured = Measured(before, mean_luminance(now, colors.weight), mean_luminance(shown.rgb, shown.weight), rolled)
    return scene.replace(cloud=after), measured


def _sources(asked: Relighting) -> Sequence[Source]:
    gone = [replace(lamp.source, strength=-lamp.source.strength) for lamp in asked.out]
    return [*(lamp.source for lamp in asked.lit), *gone, *asked.windows]


__all__ = ["Measured", "Relighting", "Tone", "relighted"]
