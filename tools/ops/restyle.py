"""The operation restyle: give the surface of the target another material, and keep its shape and the light on it."""

from __future__ import annotations

from functools import partial
from typing import Any, ClassVar, Literal

import torch
from torch import Tensor

from ...gaussians.cloud import GaussianCloud
from ...gaussians.color import Rgb, parse, rgb_to_lab, shade_of
from ...gaussians.language.query.selection import Selection
from ...gaussians.scene import Scene
from ...gaussians.world.finishes import FINISHES, Finish, FinishName
from ...gaussians.world.lengths import in_metres
from ..checks import count_matches
from ..cloud_diff import Draft, fresh_ids, joined, rows_of, selection_of
from ..color_map import LUMA, NEAR, distance
from ..coloring.materials import materials
from ..coloring.scene_light import light_around, scene_light
from ..coloring.seen import lit_color, lit_face, outline_difference, seen_colors
from ..field_update import after_recolor, recount
from ..finishing.finish import Paint, Painted, mean_pigment, painted
from ..finishing.surface import chart_of
from ..finishing.textures import Look, pigment
from ..new_objects import scene_scale
from ..operation import ColorName, Context, Length, Outcome, TargetedOp
from ..placement.bodies import Body, bodies_of
from ..receipt import Check, at_most, report

_DARKER = 0.55  # of the pigment: the second colour of a finish that names none
_PALE = 0.85  # mixed with white: the second colour of a pattern on a dark pigment
_DARK = 0.45  # luma below which a pigment is dark
_FINER = 0.25  # smallest size of the finest feature, relative to the usual one
_TOLD = 0.01  # share of the target that was left from which it is told
_SHAPE = 0.1  # share of the outline that may change: a ragged floor alone differs by .06, lost pieces by more


class Restyle(TargetedOp):
    """Give the target another material or pattern; its shape, its place and the light on it stay.

    A material has its usual colours unless `color` is given ("green marble"; oak is wood of the color oak). A colour
    alone is recolor.
    """

    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "make the sofa leather",
        {"op": "restyle", "target": {"text": "sofa"}, "material": "leather"},
    )
    op: Literal["restyle"] = "restyle"
    material: FinishName
    color: ColorName | None = None
    second: ColorName | None = None
    """The colour of joints, veins or every other stripe."""
    unit: Length | None = None
    """The length of what repeats: a brick, a tile, a stripe with its gap."""
    whole: bool = False
    """Parts of other hues (a cushion, handles) too; they are left otherwise."""

    @property
    def _finish(self) -> Finish:
        return FINISHES[self.material]

    def apply(self, scene: Scene, selection: Selection, context: Context) -> Outcome:
        bodies = bodies_of(scene, selection)
        scale = scene_scale(scene, [(body, self.target.text) for body in bodies])
        done: list[Painted] = []
        left = 0.0
        for body in bodies:
            rows, share = self._surface(scene, body)
            left = max(left, share)
            if len(rows):
                chart = chart_of(scene, rows, body.box, 1 / scale.units_per_metre)
                done.append(painted(scene.cloud, rows, chart, self._paint(scene, rows, context, chart.metres)))
        cloud, touched, removed, added = _put_in(scene.cloud, done)
        after = scene.replace(cloud=cloud)
        after = after.replace(language=recount(after.language, cloud))
        after = after.replace(language=after_recolor(after, torch.cat([touched, added])))
        ids = torch.cat([selection.ids[~torch.isin(selection.ids, removed)], added])
        focus = selection_of(selection, ids, selection.groups, selection.reason)
        notes = (*self._notes(left, len(removed), len(added)), *scale.notes)
        return Outcome(after, touched=touched, added=added, removed=removed, notes=notes, focus=focus)

    def _surface(self, scene: Scene, body: Body) -> tuple[Tensor, float]:
        """The rows of a body that are painted, and the share of it that is left because its hue is another."""
        if self.whole:
            return body.rows, 0.0
        made = materials(scene.cloud, body.rows)
        return body.rows[made.main], sum(share for _, share in made.shares)

    def _paint(self, scene: Scene, rows: Tensor, context: Context, metres: float) -> Paint:
        """What the rows `[M]` of a scene's cloud are painted with, in a scene of so many metres a unit."""
        lit = lit_color(seen_colors(scene, rows))
        luma = float(lit @ torch.tensor(LUMA, dtype=torch.float64))
        light = light_around(scene.cloud, rows, scene_light(scene.cloud), luma)
        white = torch.tensor(light.white, dtype=torch.float64)
        finish = self._finish
        look = self._look((lit / white.clamp(min=0.05)).clamp(0, 1).tolist(), metres, context.seed)
        scale = look.unit / finish.unit if finish.periodic else 1.0
        return Paint(partial(pigment, finish.name, look), white, luma, finish.detail * max(scale, _FINER), finish.shine)

    def _look(self, own: list[float], metres: float, seed: int) -> Look:
        """The colours and the size that the finish gets; `own` is the pigment of the surface before, display RGB."""
        finish = self._finish
        if self.color is not None:
            color = shade_of(self.color)
        else:
            color = parse(finish.color) if finish.color else (own[0], own[1], own[2])
        if self.second is not None:
            second = shade_of(self.second)
        elif finish.second and self.color is None:
            second = parse(finish.second)
        else:
            second = _companion(color, pattern=not finish.color)
        unit = finish.unit
        if self.unit is not None:
            said_unit = self.unit
            unit = said_unit.value * metres if said_unit.unit == "units" else in_metres(said_unit.value, said_unit.unit)
        return Look(color, second, unit, seed)

    def _notes(self, left: float, removed: int, added: int) -> tuple[str, ...]:
        """What the receipt tells."""
        notes = list[str]()
        if removed:
            notes.append(
                f"{removed:,} Gaussians became {added:,} smaller ones, so that the {self.material} can be seen"
            )
        if left > _TOLD:
            notes.append(
                f'parts of other colours were left as they are ({left:.0%}); say "the whole ..." to include them'
            )
        if self.unit is not None and not self._finish.periodic:
            notes.append(f"{self.material} has no unit that repeats, so the length was taken as the size of its grain")
        return tuple(notes)

    def check(self, before: Scene, outcome: Outcome, selection: Selection, context: Context) -> tuple[Check, ...]:
        after = outcome.scene
        was = rows_of(before.cloud, torch.cat([outcome.touched, outcome.removed]))
        now = rows_of(after.cloud, torch.cat([outcome.touched, outcome.added]))
        paint = self._paint(before, was, context, 1.0)
        asked = (mean_pigment(paint.pattern) * paint.white).clamp(0, 1)
        off = float(distance(lit_face(seen_colors(after, now)), rgb_to_lab(asked)))
        told = f"its lit faces are {off:.1f} from those of {self.material} in this light"
        if self.color or self._finish.color:
            matched = at_most("material", off, NEAR, "ΔE94", told)
        else:  # several things keep a pigment of their own each
            matched = report("material", off, "ΔE94", told)
        return matched, self._same_shape(before, was, after, now), count_matches(before, after, outcome)

    def _same_shape(self, before: Scene, was: Tensor, after: Scene, now: Tensor) -> Check:
        """The outlines are those of before: splitting Gaussians changes no shape."""
        off = outline_difference(before.cloud[was], after.cloud[now], before)
        return at_most("same shape", off, _SHAPE, "1", f"its outlines differ in {off:.1%} of their area")


def _companion(color: Rgb, *, pattern: bool) -> Rgb:
    """The second colour beside a pigment: darker; in a pattern on a dark pigment, nearly white."""
    luma = sum(w * c for w, c in zip(LUMA, color, strict=True))
    if pattern and luma < _DARK:
        return tuple(c + _PALE * (1 - c) for c in color)  # type: ignore[return-value]
    if pattern:
        return (0.96, 0.95, 0.92) if luma < 0.75 else (0.30, 0.36, 0.46)
    return (_DARKER * color[0], _DARKER * color[1], _DARKER * color[2])


def _put_in(cloud: GaussianCloud, done: list[Painted]) -> tuple[GaussianCloud, Tensor, Tensor, Tensor]:
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
