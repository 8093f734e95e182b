"""The operation recolor: give the target a new colour and keep its shading and texture."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal, Self, get_args

import torch
from pydantic import ConfigDict, Field, model_validator
from torch import Tensor

from ...gaussians.cloud import GaussianCloud
from ...gaussians.color import rgb_to_lab, shade_of
from ...gaussians.language.field.measure import Sample, lightness_spread, mean_chroma, mean_lab, sample
from ...gaussians.language.query.query import BACKGROUND, Query
from ...gaussians.language.query.selection import Selection
from ...gaussians.painted import Painted, painted_again, unpainted
from ...gaussians.scene import Scene
from ..alternatives import NOT_GIVEN, either, given
from ..checks import count_matches
from ..cloud_diff import Draft, rows_of
from ..color_map import LUMA, NEAR, distance
from ..coloring import adjust as adjusting
from ..coloring.greys import grey_shift
from ..coloring.repaint import Repaint, fit
from ..coloring.scene_light import SceneLight, light_around, scene_light
from ..coloring.seen import lit_color, lit_face, seen_colors
from ..coloring.shading import Shading
from ..coloring.surfaces import surfaces
from ..field_update import after_recolor
from ..operation import ColorName, Context, Outcome, TargetedOp, compounded
from ..receipt import Check, at_least, at_most, report

Adjust = Literal["darker", "lighter", "more_saturated", "less_saturated", "warmer", "cooler", "toward"]
_ROWS = 1 << 13  # rows written at a time: intermediates stay in a core's cache
_GREY_SHIFT = 4.0  # ΔE by which greys may shift: usual are 0 to 1, of whites turned blue 10 and more
_TOLD = 0.03  # share of the target out of the display's range from which it is told


class Recolor(TargetedOp):
    """Change the target's colour, keeping its shading and texture.

    Give either `color` alone ("make it teal"), `like` alone ("the same colour as the sofa"), or `adjust` with `amount`
    ("a bit darker": amount 0.25, "much darker": 0.8). `adjust` "toward" also needs `color` ("a bit more blue": toward,
    blue, 0.25). A new colour leaves parts of other hues, unless `whole` ("paint the whole chair").
    """

    model_config = ConfigDict(
        json_schema_extra=either(
            {"color": given(), "adjust": NOT_GIVEN, "like": NOT_GIVEN},
            {"like": given(), "color": NOT_GIVEN, "adjust": NOT_GIVEN},
            {"adjust": given(enum=[a for a in get_args(Adjust) if a != "toward"]), "color": NOT_GIVEN},
            {"adjust": given(enum=["toward"]), "color": given()},
        )
    )
    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "make the armchair teal",
        {"op": "recolor", "target": {"text": "armchair"}, "color": "teal"},
    )
    op: Literal["recolor"] = "recolor"
    color: ColorName | None = None
    """A CSS or everyday colour name ("teal", "dark green") or #rrggbb."""
    adjust: Adjust | None = None
    """A change relative to the colour it has."""
    amount: Annotated[float, Field(gt=0, le=1, allow_inf_nan=False)] = 0.5
    """How far to adjust, 0 to 1; has no effect with `color` alone."""
    like: Query | None = None
    """The thing whose colour it gets."""
    whole: bool = False
    """With `color`: parts of other hues (a cushion, handles) too; they are left otherwise."""

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        if self.like is not None and (self.color is not None or self.adjust is not None):
            raise ValueError("give either the color, or like: the thing whose colour it gets")
        if self.adjust is None and self.color is None and self.like is None:
            raise ValueError("recolor needs a color, an adjust, or like")
        if self.adjust == "toward" and self.color is None:
            raise ValueError('adjust "toward" needs the color to go toward')
        if self.adjust not in (None, "toward") and self.color is not None:
            raise ValueError(f'give either a color or adjust "{self.adjust}", not both')
        return self

    def settled(self, scene: Scene, context: Context) -> Self:
        """With the pigment of the thing that it is to be like, its lit faces without the light there."""
        if self.like is None:
            return self
        rows = rows_of(scene.cloud, context.resolve(scene, self.like).require().ids)
        lit = lit_color(seen_colors(scene, rows))
        luma = float(lit @ torch.tensor(LUMA, dtype=torch.float64))
        white = torch.tensor(light_around(scene.cloud, rows, scene_light(scene.cloud), luma).white, dtype=torch.float64)
        pigment = (lit / white.clamp(min=0.05)).clamp(0, 1)
        written = "#" + "".join(f"{round(255 * float(c)):02x}" for c in pigment)
        return self.model_copy(update={"color": written, "like": None})

    def stronger(self, times: float) -> Self | None:
        if self.like is not None:
            return None
        if self.adjust is None:  # a colour is there or on the way
            return self.model_copy(update={"adjust": "toward", "amount": times}) if times < 1 else None
        return self.model_copy(update={"amount": compounded(self.amount, times)}) if self.amount < 1 else None

    @property
    def paints_parts(self) -> bool:
        """Whether parts of other hues get a new colour too: asked for, or the scene or its background is meant."""
        if self.target.text in BACKGROUND:
            return True
        everything = self.target.text in ("", "everything") and self.target.pick == "all"
        return self.whole or (everything and not (self.target.colors or self.target.relations))

    def apply(self, scene: Scene, selection: Selection, context: Context) -> Outcome:
        draft, bare = Draft(scene.cloud), unpainted(scene.cloud, scene.painted)
        if self.color is None:
            touched, notes = selection.ids, self._adjust(scene, selection, draft)
        else:
            touched, notes = self._paint(scene, bare, selection, draft)
        after = scene.replace(cloud=draft.done())
        painted = self._record(scene, bare, after, touched)
        after = after.replace(language=after_recolor(after, touched), painted=painted)
        return Outcome(after, touched=touched, notes=tuple(notes))

    def _record(self, scene: Scene, bare: GaussianCloud, after: Scene, touched: Tensor) -> Painted | None:
        """What is known of paint after this; an adjustment of what was never painted is none."""
        if self.color is None and scene.painted is None:
            return None
        rows = rows_of(after.cloud, touched)
        if self.color is None:
            rows = rows[(bare.sh[rows] != scene.cloud.sh[rows]).flatten(1).any(dim=1)]
        return painted_again(scene.painted, bare, after.cloud, rows)

    def _adjust(self, scene: Scene, selection: Selection, draft: Draft) -> list[str]:
        """Change the light or the pigment of the whole selection alike; notes for the receipt."""
        rows = rows_of(scene.cloud, selection.ids)
        colors = seen_colors(scene, rows)
        change = self._adjustment(scene.cloud, colors)
        if isinstance(change, adjusting.Lift):
            _write(draft, scene.cloud, rows, change, Shading.of(scene.cloud, rows))
        else:
            draft.map("sh", rows, change.on_harmonics)
        return _clipping(adjusting.clipped(colors.rgb, change(colors.rgb), colors.weight))

    def _adjustment(self, cloud: GaussianCloud, colors: Sample) -> adjusting.Change:
        if self.adjust == "darker":
            return adjusting.darker(colors, self.amount)
        if self.adjust == "lighter":
            return adjusting.lighter(colors, self.amount)
        if self.adjust in ("warmer", "cooler"):
            return adjusting.shown_warmth(colors, self.amount if self.adjust == "warmer" else -self.amount)
        factor = 1 + 1.5 * self.amount if self.adjust == "more_saturated" else 1 - self.amount
        return adjusting.Saturation(factor, scene_light(cloud).tint)

    def _paint(self, scene: Scene, bare: GaussianCloud, selection: Selection, draft: Draft) -> tuple[Tensor, list[str]]:
        """Give every surface of the selection a map to the colour; ids that were painted, and notes.

        A new colour starts from the scene before any paint, `bare`, so that a second coat costs no shading.
        """
        found = surfaces(scene, selection, whole=self.paints_parts, bare=bare)
        scene = scene if self.adjust is not None else scene.replace(cloud=bare)
        light = scene_light(scene.cloud)
        clipped = 0.0
        for rows in found.painted:
            colors = seen_colors(scene, rows)
            made = fit(colors, self.aim(scene.cloud, rows, colors, light))
            if self.adjust is not None:
                made = made.mixed(self.amount)
            _write(draft, scene.cloud, rows, made, Shading.of(scene.cloud, rows))
            clipped = max(clipped, adjusting.clipped(colors.rgb, made(colors.rgb), colors.weight))
        painted = scene.cloud.ids[torch.cat(found.painted)].sort().values
        notes = [note for note in (found.note(), light.note()) if note is not None]
        return painted, [*notes, *_clipping(clipped)]

    def aim(self, cloud: GaussianCloud, rows: Tensor, colors: Sample, light: SceneLight) -> Tensor:
        """`[3]` display colour that the requested pigment has on lit faces, where the rows `[M]` of the cloud are."""
        lit = float(lit_color(colors) @ torch.tensor(LUMA, dtype=torch.float64))
        return light_around(cloud, rows, light, lit).on(self._pigment()).clamp(0, 1)

    def _pigment(self) -> Tensor:
        """`[3]` display colour of the requested pigment in good neutral light (see `gaussians.color.shade_of`)."""
        assert self.color is not None
        return torch.tensor(shade_of(self.color), dtype=torch.float64)

    def check(self, before: Scene, outcome: Outcome, selection: Selection, context: Context) -> tuple[Check, ...]:
        if self.adjust is None:
            before = before.replace(cloud=unpainted(before.cloud, before.painted))
        rows = rows_of(before.cloud, outcome.touched)
        was, now = (seen_colors(s, rows_of(s.cloud, outcome.touched)) for s in (before, outcome.scene))
        checks = [self._arrived(before.cloud, rows, was, now), count_matches(before, outcome.scene, outcome)]
        if self.adjust in ("darker", "lighter"):
            still = outcome.touched[torch.isin(outcome.touched, outcome.scene.cloud.ids)]
            shift = grey_shift(*(sample(s.cloud, rows_of(s.cloud, still)) for s in (before, outcome.scene)))
            checks.append(
                at_most("greys stay grey", shift, _GREY_SHIFT, "ΔE", f"the hue of greys shifted by {shift:.1f}")
            )
        if self.adjust is None:
            texture, kept = lightness_spread(was), lightness_spread(now)
            said = f"spread of lightness (shading, texture) went from {texture:.1f} to {kept:.1f}"
            if texture > 2:  # even a pure colour at the end of the display's range keeps a twentieth of it
                checks.append(at_least("texture kept", kept / texture, 0.05, "1", said))
            else:
                checks.append(report("texture kept", kept / max(texture, 1e-9), "1", said))
        return tuple(checks)

    def _arrived(self, cloud: GaussianCloud, rows: Tensor, was: Sample, now: Sample) -> Check:
        """The lit faces have the requested colour, or the colour changed in the requested direction."""
        if self.adjust is None:
            asked = self.aim(cloud, rows, was, scene_light(cloud))
            off = float(distance(lit_face(now), rgb_to_lab(asked)))
            return at_most("colour", off, NEAR, "ΔE94", f"its lit faces are {off:.1f} from {self.color} in this light")
        step = self._progress(was, now)
        said = f"its colour moved by {step:.1f} in Lab"
        return at_least(f"{self.adjust.replace('_', ' ')}", step, 0.2, "ΔE", said)

    def _progress(self, was: Sample, now: Sample) -> float:
        """How far the colour moved in the requested direction, in Lab: of the lit faces, for warmth of the mean, or for
        saturation of the mean chroma (of many colours the mean is grey).

        These two change chroma only, and the median chroma of a striped thing may be that of its white stripes.
        """
        if self.adjust in ("more_saturated", "less_saturated"):
            gain = mean_chroma(now) - mean_chroma(was)
            return gain if self.adjust == "more_saturated" else -gain
        old, new = mean_lab(was), mean_lab(now)
        if self.adjust in ("warmer", "cooler"):
            return float(new[2] - old[2]) * (1 if self.adjust == "warmer" else -1)
        old, new = lit_face(was), lit_face(now)
        if self.adjust in ("darker", "lighter"):
            return float(new[0] - old[0]) * (1 if self.adjust == "lighter" else -1)
        asked = rgb_to_lab(self._pigment())
        return float(torch.linalg.vector_norm(old - asked) - torch.linalg.vector_norm(new - asked))


def _write(draft: Draft, cloud: GaussianCloud, rows: Tensor, made: Repaint | adjusting.Lift, shading: Shading) -> None:
    for block in torch.split(rows, _ROWS):
        draft.write("sh", block, made.on_harmonics(cloud.sh[block], shading.at(cloud.means[block])))


def _clipping(share: float) -> list[str]:
    return [f"{share:.0%} of it by area is brighter or purer than a display can show"] if share > _TOLD else []
