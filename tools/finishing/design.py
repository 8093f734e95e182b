"""What a surface is to look like: the texture of a material in its colours, or that of a picture; and how it is laid on
some Gaussians of a scene."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import torch
from torch import Tensor

from ...gaussians.cloud import GaussianCloud
from ...gaussians.color import Rgb, parse, shade_of
from ...gaussians.scene import Scene
from ...gaussians.world.finishes import Finish
from ..cloud_diff import Draft, fresh_ids, joined
from ..color_map import LUMA
from ..coloring.scene_light import light_around, scene_light
from ..coloring.seen import lit_color, seen_colors
from .exemplar import Exemplar, pigment_of
from .finish import Paint, Painted, Pattern
from .textures import Look, pigment

_DARKER = 0.55  # of the pigment: the second colour of a finish that names none
_PALE = 0.85  # mixed with white: the second colour of a pattern on a dark pigment
_DARK = 0.45  # luma below which a pigment is dark
_PALE_FROM, _JOINT = 0.55, 0.78  # luma of a pale brick, and how dark its joints are relative to it
_FINER = 0.25  # smallest size of the finest feature, relative to the usual one
_SHEEN = 0.2  # shine of a texture that was taken from a picture


@dataclass(frozen=True, eq=False)
class Design:
    """A texture, the size of its finest feature in metres, and its shine; see `Paint`."""

    pattern: Pattern
    detail: float
    shine: float


@dataclass(frozen=True)
class Choice:
    """What was said of a finish.

    Attributes:
        color, second: its colours, "" for its own.
        unit: the length of what repeats, metres; None for its own.
        seed: of what is irregular.
    """

    color: str = ""
    second: str = ""
    unit: float | None = None
    seed: int = 0


def of_finish(finish: Finish, choice: Choice, own: Rgb) -> Design:
    """The design of a finish; `own` is the pigment of the surface before, which patterns without a colour keep.

    Raises:
        UserError: a colour is unknown.
    """
    usual = parse(finish.color) if finish.color else own
    color = shade_of(choice.color) if choice.color else usual
    if choice.second:
        second = shade_of(choice.second)
    elif finish.second:
        second = parse(finish.second) if not choice.color else _beside(color, usual, parse(finish.second))
    else:
        second = _companion(color, pattern=not finish.color)
    look = Look(color, second, finish.unit if choice.unit is None else choice.unit, choice.seed)
    scale = look.unit / finish.unit if finish.periodic else 1.0
    return Design(partial(pigment, finish.name, look), finish.detail * max(scale, _FINER), finish.shine)


def of_exemplar(exemplar: Exemplar) -> Design:
    """The design of a texture that was taken from a picture."""
    return Design(partial(pigment_of, exemplar), exemplar.detail, _SHEEN)


def _beside(color: Rgb, usual: Rgb, second: Rgb) -> Rgb:
    """The second colour of a finish whose first is another than usual: as much darker or lighter; beside a pale colour
    never lighter."""
    ratio = _luma(second) / max(_luma(usual), 0.02)
    if ratio > 1 and _luma(color) > _PALE_FROM:
        ratio = _JOINT
    return tuple(min(1.0, c * ratio) for c in color)  # type: ignore[return-value]


def _luma(color: Rgb) -> float:
    return sum(w * c for w, c in zip(LUMA, color, strict=True))


def _companion(color: Rgb, *, pattern: bool) -> Rgb:
    """The second colour beside a pigment: darker; in a pattern on a dark pigment, nearly white."""
    luma = _luma(color)
    if pattern and luma < _DARK:
        return tuple(c + _PALE * (1 - c) for c in color)  # type: ignore[return-value]
    if pattern:
        return (0.96, 0.95, 0.92) if luma < 0.75 else (0.30, 0.36, 0.46)
    return (_DARKER * color[0], _DARKER * color[1], _DARKER * color[2])


@dataclass(frozen=True, eq=False)
class Lit:
    """The light on some Gaussians.

    Attributes:
        white: `[3]` display colour of white there.
        luma: of their lit faces.
        own: the pigment that those have, display RGB in good neutral light.
    """

    white: Tensor
    luma: float
    own: Rgb

    @classmethod
    def of(cls, scene: Scene, rows: Tensor) -> Lit:
        """The light on the rows `[M]` of a scene's cloud."""
        lit = lit_color(seen_colors(scene, rows))
        luma = float(lit @ torch.tensor(LUMA, dtype=torch.float64))
        light = light_around(scene.cloud, rows, scene_light(scene.cloud), luma)
        white = torch.tensor(light.white, dtype=torch.float64)
        red, green, blue = (lit / white.clamp(min=0.05)).clamp(0, 1).tolist()
        return cls(white, luma, (red, green, blue))

    def paint(self, design: Design) -> Paint:
        """The paint that shows a design in this light."""
        return Paint(design.pattern, self.white, self.luma, design.detail, design.shine)


def put_in(cloud: GaussianCloud, done: list[Painted]) -> tuple[GaussianCloud, Tensor, Tensor, Tensor]:
    """The cloud with what was painted; ids that were touched, removed and added."""
    if not done:
        none = torch.zeros(0, dtype=torch.int64)
        return cloud, none, none, none
    draft = Draft(cloud)
    for part in done:
        draft.write("sh", part.kept, part.sh)
    kept = torch.cat([part.kept for part in done])
    split = torch.cat([part.split for part in done])
    touched, removed = cloud.ids[kept].sort().values, cloud.ids[split].sort().values
    if not len(split):
        return draft.done(), touched, removed, removed
    count = sum(len(part.children) for part in done)
    ids = fresh_ids(cloud, count)
    added, start = [], 0
    for part in done:
        added.append(part.children.replace(ids=ids[start : start + len(part.children)]))
        start += len(part.children)
    gone = torch.zeros(len(cloud), dtype=torch.bool)
    gone[split] = True
    return joined(draft.done(), gone, added), touched, removed, ids
