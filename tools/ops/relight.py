"""The operation relight: change the light of the whole scene or of a thing, or turn lamps on and off.

Colours are re-weighted; no light is traced (see `lighting`).
"""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
import torch
from pydantic import ConfigDict, Field, model_validator
from torch import Tensor

from ...gaussians.color import parse
from ...gaussians.errors import AbsentError
from ...gaussians.language.query.query import ALL
from ...gaussians.language.query.selection import Selection, mask_of
from ...gaussians.scene import Scene
from ..alternatives import Given, Keywords, either, given
from ..checks import count_matches
from ..cloud_diff import rows_of
from ..coloring.scene_light import scene_light
from ..field_update import after_recolor
from ..lighting.lamps import Lamp, lamp_kind, lamp_of, lamps_in, windows_in
from ..lighting.light import colors_of, mean_luminance
from ..lighting.moods import Mood, MoodName, light_of, moods, tinted
from ..lighting.relighting import Measured, Relighting, relighted
from ..lighting.space import Sky, direction_of
from ..lighting.whites import COLDEST, NEUTRAL, WARMEST, kelvin_of, warmer_by
from ..new_objects import scene_scale
from ..operation import ColorName, Context, Outcome, TargetedOp, compounded
from ..placement.bodies import Array, bodies_of, heading
from ..receipt import Check, at_most, report

Side = Literal["left", "right", "front", "behind", "above", "window"]

_OFF = 0.15  # times the light that is there, when all lights go out in a room without lamps, or with
_NIGHT = 9000.0  # kelvins of what is left then
_GOOD = 0.24  # mean luminance of a well-lit room, to which lights that are turned on bring it
_ON = (1.25, 8.0)  # factors that they do it by
_MIREDS = 130.0  # by which `warmth` 1 shifts the white point
_CLOSE = 0.05  # relative error of the mean luminance
_TOLD = 0.02  # share of the surfaces that is rolled off from which it is told
_TRUST = 0.5  # share of the tint of a scene's white surfaces that is taken for light, the rest for paint
_SAME = 2.0  # mireds by which a white point counts as neutral
_BRIGHTER = 4.0  # times, at most, that a lamp is brighter against what is left of the other light
_LEAST = 1e-4  # mean luminance below which there is nothing to measure
_WAYS = ("mood", "exposure", "kelvin", "warmth", "color", "contrast", "side", "lamps")
_ONE_WAY: list[dict[str, Given | Keywords]] = [{name: given()} for name in _WAYS]


class Relight(TargetedOp):
    """Change the light on the target, or on "everything" (pick "all"), not its paint.

    Give at least one of its fields. With `lamps` the target is lamps, or everything for all the lights of a room.
    """

    model_config = ConfigDict(json_schema_extra=either(*_ONE_WAY))
    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "make the room a third brighter",
        {"op": "relight", "target": {"text": "everything", "pick": "all"}, "exposure": 1.333},
    )
    op: Literal["relight"] = "relight"
    mood: MoodName | None = None
    exposure: Annotated[float, Field(gt=0, le=1000, allow_inf_nan=False)] | None = None
    """Times the light: 1.33 a third brighter, 0.5 half as bright."""
    kelvin: Annotated[float, Field(ge=WARMEST, le=COLDEST, allow_inf_nan=False)] | None = None
    """White point: 2700 a warm bulb, 6500 daylight."""
    warmth: Annotated[float, Field(ge=-1, le=1, allow_inf_nan=False)] | None = None
    """Warmer than now, or cooler (negative)."""
    color: ColorName | None = None
    """Coloured light: "blue". White and the tones of lamps and daylight are `kelvin` and `warmth`."""
    contrast: Annotated[float, Field(gt=0, le=2, allow_inf_nan=False)] | None = None
    """Above 1 harder, below 1 softer light."""
    side: Side | None = None
    """Where the light comes from, as the viewer sees it."""
    lamps: Literal["on", "off"] | None = None
    amount: Annotated[float, Field(gt=0, le=2, allow_inf_nan=False)] = 1.0
    """How much of `mood`, `color` or `side`."""

    @model_validator(mode="after")
    def _something(self) -> Self:
        if all(getattr(self, name) is None for name in _WAYS):
            raise ValueError(f"relight needs one of {', '.join(_WAYS)}")
        return self

    @property
    def everywhere(self) -> bool:
        """Whether the target is the whole scene."""
        return self.target.text.lower() in ALL and self.target.pick == "all"

    def may_change(self, scene: Scene, selection: Selection) -> Tensor:
        if self.lamps is not None:  # what stands around a lamp is lit by it
            return torch.ones(len(scene.cloud), dtype=torch.bool, device=scene.cloud.device)
        return mask_of(scene.cloud, selection.ids)

    def stronger(self, times: float) -> Self | None:
        changed: dict[str, Any] = {}
        if self.exposure is not None:
            changed["exposure"] = min(max(self.exposure**times, 0.02), 20.0)
        if self.warmth is not None and self.warmth:
            changed["warmth"] = math.copysign(compounded(min(abs(self.warmth), 0.999), times), self.warmth)
        if self.kelvin is not None:
            changed["kelvin"] = warmer_by(NEUTRAL, times * (1e6 / self.kelvin - 1e6 / NEUTRAL))
        if self.contrast is not None:
            changed["contrast"] = min(max(self.contrast**times, 0.3), 2.0)
        if self.mood is not None or self.side is not None or self.color is not None or self.lamps == "on":
            changed["amount"] = min(self.amount * times, 2.0)
        return self.model_copy(update=changed) if changed else None

    def apply(self, scene: Scene, selection: Selection, context: Context) -> Outcome:
        unit = 1 / scene_scale(scene).units_per_metre
        lamps = self._lamps(scene, selection, unit)
        asked = self._asked(scene, lamps, context, unit)
        rows = None if self.everywhere or self.lamps is not None else rows_of(scene.cloud, selection.ids)
        after, measured = relighted(scene, rows, asked, unit)
        if after is scene:
            return Outcome(scene, notes=("the light is like that already",))
        touched = scene.cloud.ids if rows is None else selection.ids
        after = after.replace(language=after_recolor(after, touched))
        return Outcome(after, touched=touched.sort().values, notes=self._notes(scene, asked, measured))

    def _lamps(self, scene: Scene, selection: Selection, unit: float) -> list[Lamp]:
        """The lamps that are lit or put out.

        Raises:
            AbsentError: a lamp is meant, and what was found is none.
        """
        if self.lamps is None or self.everywhere:
            mood = moods()[self.mood] if self.mood is not None else None
            wanted = "all" if self.lamps is not None else mood.lamps if mood is not None and self.everywhere else ""
            return [lamp for lamp in lamps_in(scene, unit) if wanted == "all" or lamp.flame] if wanted else []
        found = []
        for body in bodies_of(scene, selection):
            if body.label and lamp_kind(body.label) is None and lamp_kind(self.target.text) is None:
                raise AbsentError(f"{body.label} is no lamp: name a lamp of the scene, or change the light of the room")
            name = body.label if lamp_kind(body.label) is not None else self.target.text
            lamp = lamp_of(scene, body.rows, name, body.group, unit)
            found += [lamp] if lamp is not None else []
        if not found:
            raise AbsentError("there is no lamp to turn on or off: change the light of the room instead")
        return found

    def _asked(self, scene: Scene, lamps: list[Lamp], context: Context, unit: float) -> Relighting:
        """What happens to the light."""
        mood = moods()[self.mood].scaled(self.amount) if self.mood is not None else Mood("")
        old = _kelvin(scene)
        new = mood.kelvin
        if self.kelvin is not None:
            new = self.kelvin
        if self.warmth is not None:
            new = warmer_by(new or old, self.warmth * _MIREDS)
        exposure = mood.exposure * (self.exposure or 1.0)
        if self.lamps is not None and self.everywhere:
            exposure *= self._switched(scene, bool(lamps))
            new = _NIGHT if self.lamps == "off" and new is None else new
        contrast = mood.contrast * (self.contrast or 1.0)
        light = light_of(exposure, old, new or old, contrast, mood.saturation)
        if self.color is not None:
            light = tinted(light, parse(self.color), self.amount)
        windows = windows_in(scene, unit, mood.windows, new or NEUTRAL) if mood.windows and self.everywhere else []
        sky = self._sky(scene, mood, context, unit)
        out = tuple(lamp.times(self.amount) for lamp in lamps) if self.lamps == "off" else ()
        against = self.amount * min(max(1 / exposure, 1.0), _BRIGHTER)
        lit = tuple(lamp.times(against) for lamp in lamps) if self.lamps != "off" else ()
        if self.everywhere and self.lamps == "off":
            lit, out = (), tuple(lamp.times(0.0) for lamp in lamps)
        return Relighting(light, new or old, sky, lit, out, tuple(windows))

    def _switched(self, scene: Scene, has_lamps: bool) -> float:
        """Factor of the light that is there, when all lights are turned on or off."""
        if self.lamps == "off":
            return _OFF**self.amount
        colors = colors_of(scene.cloud)
        level = max(mean_luminance(colors.rgb, colors.weight), _LEAST)
        factor = min(max(_GOOD / level, 1.0 if has_lamps else _ON[0]), _ON[1])
        return float(factor**self.amount)

    def _sky(self, scene: Scene, mood: Mood, context: Context, unit: float) -> Sky | None:
        """The side from which the light comes; that of the windows, else of the left above the viewer."""
        amount = self.amount if self.side is not None else mood.sky
        if amount <= 0:
            return None
        up = scene.frame.up_vector
        if self.side in (None, "window"):
            level = _to_windows(scene, unit)
            if level is None and self.side == "window":
                raise AbsentError("no window was found: say from which side the light comes")
            if level is None:
                level = heading(context.viewer, scene.frame, "left")
            return Sky(direction_of(level + 0.55 * up), min(amount, 1.0))
        if self.side == "above":
            return Sky(direction_of(up), min(amount, 1.0))
        way = {"left": "left", "right": "right", "front": "backward", "behind": "forward"}[self.side]
        return Sky(direction_of(heading(context.viewer, scene.frame, way) + 0.4 * up), min(amount, 1.0))  # type: ignore[arg-type]

    def _notes(self, scene: Scene, asked: Relighting, measured: Measured) -> tuple[str, ...]:
        """What the receipt tells."""
        told = []
        if measured.before > _LEAST:
            told.append(f"mean luminance {measured.after / measured.before - 1:+.0%}")
        old = _kelvin(scene)
        if old != asked.kelvin:
            told.append(f"white point {round(old, -2):.0f} -> {round(asked.kelvin, -2):.0f} K")
        if self.color is not None:
            told.append(f"{self.color} light")
        for name, things in (("lamp", asked.lit), ("window", asked.windows)):
            if things:
                told.append(f"light of {len(things)} {name}{'s' if len(things) > 1 else ''}")
        if asked.out:
            told.append(f"{len(asked.out)} lamp{'s' if len(asked.out) > 1 else ''} out")
        notes = [f"{', '.join(told)}; colours were re-weighted, no light was traced"]
        if measured.rolled > _TOLD:
            notes.append(f"{measured.rolled:.0%} of it by area is as bright as a display can show")
        if self.lamps == "on" and self.everywhere and not asked.lit:
            notes.append("no lamp was found, so the light of the whole room was raised")
        return tuple(notes)

    def check(self, before: Scene, outcome: Outcome, selection: Selection, context: Context) -> tuple[Check, ...]:
        checks = [count_matches(before, outcome.scene, outcome)]
        was, now = (colors_of(s.cloud, rows_of(s.cloud, outcome.touched)) for s in (before, outcome.scene))
        old, new = (mean_luminance(c.rgb, c.weight) for c in (was, now))
        if not len(outcome.touched) or old < _LEAST:
            return tuple(checks)
        ratio = new / old
        said = f"its mean luminance is {ratio:.2f} times what it was"
        if self.exposure is not None and self.mood is None and self.lamps is None:
            fits = was.rgb.clamp(0, 1).amax(dim=1) * max(self.exposure, 1.0) ** (1 / 2.2) < 0.9
            if float(was.weight[fits].sum()) > 0.95:
                return (*checks, at_most("exposure", abs(ratio / self.exposure - 1), _CLOSE, "1", said))
        return (*checks, report("exposure", ratio, "1", said))


def _kelvin(scene: Scene) -> float:
    """The white point of a scene, halfway in mireds between neutral and that of its bright near-neutral surfaces, which
    may be painted."""
    light = scene_light(scene.cloud)
    seen = kelvin_of(np.array(light.white)) if light.share > 0 else NEUTRAL
    found = warmer_by(NEUTRAL, _TRUST * (1e6 / seen - 1e6 / NEUTRAL))
    return NEUTRAL if abs(1e6 / found - 1e6 / NEUTRAL) < _SAME else found


def _to_windows(scene: Scene, unit: float) -> Array | None:
    """Level direction `[3]` from the middle of the scene to its windows, None if there are none."""
    windows = windows_in(scene, unit, 1.0, NEUTRAL)
    if not windows:
        return None
    step = max(1, len(scene.cloud) // 4096)
    middle = scene.cloud.means[::step].median(dim=0).values.double().cpu().numpy()
    way = np.mean([np.array(w.place) - middle for w in windows], axis=0)
    up = scene.frame.up_vector
    level = way - up * (way @ up)
    length = float(np.linalg.norm(level))
    return np.asarray(level / length) if length > 1e-9 else None
