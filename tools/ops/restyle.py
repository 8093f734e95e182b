"""The operation restyle: give the surface of the target another material, that of another thing, or that of a
photograph; its shape and the light on it stay."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, ClassVar, Literal, Self

import torch
from pydantic import ConfigDict, Field, PrivateAttr, model_validator
from torch import Tensor

from ...gaussians.color import rgb_to_lab
from ...gaussians.errors import InstructionError
from ...gaussians.language.query.query import Query
from ...gaussians.language.query.selection import Selection
from ...gaussians.scene import Scene
from ...gaussians.world.finishes import FINISHES, FinishName, described
from ...gaussians.world.lengths import in_metres
from ...gaussians.world.styles import StyleName, material_for, materials_of
from ..alternatives import NOT_GIVEN, either, given
from ..checks import count_matches
from ..cloud_diff import rows_of, selection_of
from ..color_map import NEAR, distance
from ..coloring.materials import materials
from ..coloring.seen import lit_face, outline_difference, seen_colors
from ..field_update import after_recolor, recount
from ..finishing.design import Choice, Design, Lit, of_finish, put_in
from ..finishing.finish import Painted, mean_pigment, painted
from ..finishing.surface import chart_of
from ..finishing.taking import Taken, from_reference, from_thing, one_of_alike
from ..new_objects import scene_scale
from ..operation import ColorName, Context, Length, Outcome, TargetedOp
from ..placement.bodies import Body, bodies_of
from ..receipt import Check, at_most, report

_STYLED = 25_000  # Gaussians that a style adds to one thing at most: it dresses many
_TOLD = 0.01  # share of the target that was left from which it is told
_SHAPE = 0.1  # share of the outline that may change: a ragged floor alone differs by .06, lost pieces by more


class Restyle(TargetedOp):
    """Give the target another material or pattern; its shape, its place and the light on it stay.

    Give `material` ("make it marble"), `style` for a whole room ("a rustic look"), `like` ("the pattern of the
    curtain", "wood like the table"), or `reference` ("like in the photo"). A material has its usual colours unless
    `color` is given ("green marble"; oak is wood of the color oak). A colour alone is recolor.
    """

    model_config = ConfigDict(
        json_schema_extra=either(
            {
                "material": given(),
                "like": NOT_GIVEN,
                "reference": NOT_GIVEN,
                "width": NOT_GIVEN,
                "style": NOT_GIVEN,
            },
            {"like": given(), "reference": NOT_GIVEN, "width": NOT_GIVEN, "style": NOT_GIVEN},
            {"reference": given(), "like": NOT_GIVEN, "style": NOT_GIVEN},
            {
                "style": given(),
                "material": NOT_GIVEN,
                "like": NOT_GIVEN,
                "reference": NOT_GIVEN,
                "width": NOT_GIVEN,
                "color": NOT_GIVEN,
                "second": NOT_GIVEN,
                "unit": NOT_GIVEN,
            },
        )
    )
    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "make the sofa leather",
        {"op": "restyle", "target": {"text": "sofa"}, "material": "leather"},
    )
    op: Literal["restyle"] = "restyle"
    material: FinishName | None = None
    """With `like` or `reference`: what is said to be seen there."""
    color: ColorName | None = None
    second: ColorName | None = None
    """The colour of joints, veins or every other stripe."""
    unit: Length | None = None
    """The length of what repeats: a brick, a tile, a stripe with its gap."""
    like: Query | None = None
    """The thing whose material or pattern it gets."""
    reference: Annotated[str, Field(min_length=1, max_length=120)] | None = None
    """The name of a photograph that the user gave, "photo" for the only one."""
    width: Length | None = None
    """How wide the place is that the photograph shows."""
    style: StyleName | None = None
    """A style, which gives each floor, wall and piece of furniture of the target a material of its own."""
    whole: bool = False
    """Parts of other hues (a cushion, handles) too; they are left otherwise."""

    _taken: Taken | None = PrivateAttr(default=None)

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        if self.like is not None and self.reference is not None:
            raise ValueError("give either like or reference, not both")
        others = (self.material, self.like, self.reference, self.width, self.color, self.second, self.unit)
        if self.style is not None and any(value is not None for value in others):
            raise ValueError("a style stands alone: it chooses the materials")
        if self.style is None and self.material is None and self.like is None and self.reference is None:
            raise ValueError("restyle needs a material, like (a thing), reference (a photograph), or a style")
        if self.width is not None and self.reference is None:
            raise ValueError("width is that of a reference; the size of what repeats is unit")
        return self

    @property
    def called(self) -> str:
        """What it becomes, in words."""
        if self.like is not None:
            return f"the surface of {self.like.describe()}"
        if self.style is not None:
            return f"the {self.style} style"
        return "the photograph" if self.reference is not None else str(self.material)

    def settled(self, scene: Scene, context: Context) -> Self:
        """With the texture of the thing or of the photograph that it is to be like."""
        if self.like is None and self.reference is None:
            return self
        settled = self.model_copy()
        settled._taken = self._take(scene, context)
        return settled

    def _take(self, scene: Scene, context: Context) -> Taken:
        """The texture that a thing or a photograph gives."""
        finish = FINISHES[self.material] if self.material is not None else None
        if self.reference is not None:
            width = _in_metres(self.width, 1.0)
            return from_reference(self.reference, context.references, width, finish, self.unit is not None)
        assert self.like is not None
        source = one_of_alike(scene, self.like, context)
        return from_thing(scene, source, finish, self.unit is not None)

    def apply(self, scene: Scene, selection: Selection, context: Context) -> Outcome:
        if self._taken is None and (self.like is not None or self.reference is not None):
            return self.settled(scene, context).apply(scene, selection, context)
        self._refuse_itself(selection)
        bodies = bodies_of(scene, selection)
        chosen = self._chosen(bodies)
        bodies = [body for body in bodies if self.style is None or body.label in chosen]
        scale = scene_scale(scene, [(body, self.target.text) for body in bodies])
        done: list[Painted] = []
        left = 0.0
        for body in bodies:
            rows, share = self._surface(scene, body)
            left = max(left, share if self.style is None else 0.0)
            if len(rows):
                chart = chart_of(scene, rows, body.box, 1 / scale.units_per_metre)
                light = Lit.of(scene, rows)
                phrase = chosen.get(body.label, "")
                design = (
                    _styled(phrase, body.label, light) if phrase else self._design(light, chart.metres, context.seed)
                )
                most = _STYLED if phrase else None
                done.append(painted(scene.cloud, rows, chart, light.paint(design), most))
        cloud, touched, removed, added = put_in(scene.cloud, done)
        after = scene.replace(cloud=cloud)
        after = after.replace(language=recount(after.language, cloud))
        after = after.replace(language=after_recolor(after, torch.cat([touched, added])))
        ids = torch.cat([selection.ids[~torch.isin(selection.ids, removed)], added])
        focus = selection_of(selection, ids, selection.groups, selection.reason)
        notes = (*_told(chosen), *self._notes(left, len(removed), len(added)), *scale.notes)
        return Outcome(after, touched=touched, added=added, removed=removed, notes=notes, focus=focus)

    def _chosen(self, bodies: Sequence[Body]) -> dict[str, str]:
        """The material that the style gives each name among some bodies; nothing without a style.

        Raises:
            InstructionError: it gives none to any of them.
        """
        if self.style is None:
            return {}
        table = materials_of()[self.style]
        chosen = {body.label: phrase for body in bodies if (phrase := material_for(body.label, table))}
        if not chosen:
            raise InstructionError(
                f"the {self.style} style has no material for anything here: it is about {', '.join(table)}; "
                "name what is to change and a material"
            )
        return chosen

    def _refuse_itself(self, selection: Selection) -> None:
        """Raises InstructionError if the pattern is that of the target itself, or of a part of it."""
        source = self._taken.ids if self._taken is not None else frozenset()
        if source and self.like is not None and not source.isdisjoint(selection.ids.tolist()):
            raise InstructionError(
                f"{self.like.describe()} is part of what is to be changed: name another thing to take the pattern from"
            )

    def _surface(self, scene: Scene, body: Body) -> tuple[Tensor, float]:
        """The rows of a body that are painted, and the share of it that is left because its hue is another."""
        if self.whole:
            return body.rows, 0.0
        made = materials(scene.cloud, body.rows)
        return body.rows[made.main], sum(share for _, share in made.shares)

    def _design(self, light: Lit, metres: float, seed: int) -> Design:
        """What is painted on a surface in its light, in a scene of so many metres a unit."""
        finish = FINISHES[self.material] if self.material is not None else None
        choice = self._choice(metres, seed)
        if self._taken is not None:
            return self._taken.design(finish, choice, metres)
        assert finish is not None
        return of_finish(finish, choice, light.own)

    def _choice(self, metres: float, seed: int) -> Choice:
        return Choice(self.color or "", self.second or "", _in_metres(self.unit, metres), seed)

    def _notes(self, left: float, removed: int, added: int) -> tuple[str, ...]:
        """What the receipt tells."""
        notes = list(self._taken.notes if self._taken is not None else ())
        if removed:
            notes.append(f"{removed:,} Gaussians became {added:,} smaller ones, so that {self.called} can be seen")
        if left > _TOLD:
            notes.append(
                f'parts of other colours were left as they are ({left:.0%}); say "the whole ..." to include them'
            )
        finish = FINISHES[self.material] if self.material is not None and self._taken is None else None
        if self.unit is not None and finish is not None and not finish.periodic:
            notes.append(f"{self.material} has no unit that repeats, so the length was taken as the size of its grain")
        return tuple(notes)

    def check(self, before: Scene, outcome: Outcome, selection: Selection, context: Context) -> tuple[Check, ...]:
        if self._taken is None and (self.like is not None or self.reference is not None):
            return self.settled(before, context).check(before, outcome, selection, context)
        after = outcome.scene
        was = rows_of(before.cloud, torch.cat([outcome.touched, outcome.removed]))
        if self.style is not None:
            now = rows_of(after.cloud, torch.cat([outcome.touched, outcome.added]))
            return self._same_shape(before, was, after, now), count_matches(before, after, outcome)
        now = rows_of(after.cloud, torch.cat([outcome.touched, outcome.added]))
        light = Lit.of(before, was)
        design = self._design(light, 1.0, context.seed)
        asked = (mean_pigment(design.pattern) * light.white).clamp(0, 1)
        off = float(distance(lit_face(seen_colors(after, now)), rgb_to_lab(asked)))
        told = f"its lit faces are {off:.1f} from those of {self.called} in this light"
        if self.material is not None and (self.color or FINISHES[self.material].color) and self._taken is None:
            matched = at_most("material", off, NEAR, "ΔE94", told)
        else:  # several things keep a pigment of their own each, and the lit half of a bold pattern is not its mean
            matched = report("material", off, "ΔE94", told)
        return matched, self._same_shape(before, was, after, now), count_matches(before, after, outcome)

    def _same_shape(self, before: Scene, was: Tensor, after: Scene, now: Tensor) -> Check:
        """The outlines are those of before: splitting Gaussians changes no shape."""
        off = outline_difference(before.cloud[was], after.cloud[now], before)
        return at_most("same shape", off, _SHAPE, "1", f"its outlines differ in {off:.1%} of their area")


def _styled(phrase: str, label: str, light: Lit) -> Design:
    """The design of what a style says of something; wood on floors, walls and ceilings comes in boards."""
    said = described(phrase)
    assert said is not None
    flat = label in ("floor", "wall", "ceiling", "ground")
    finish = "planks" if flat and said.finish == "wood" else said.finish or "plastic"
    return of_finish(FINISHES[finish], Choice(said.color, said.second), light.own)


def _told(chosen: Mapping[str, str]) -> tuple[str, ...]:
    """What a style chose, as a note."""
    told = ", ".join(f"{label}: {phrase}" for label, phrase in chosen.items())
    return (f"it was read as {told}",) if told else ()


def _in_metres(length: Length | None, metres: float) -> float | None:
    """A length in metres, in a scene of so many metres a unit; None stays."""
    if length is None:
        return None
    return length.value * metres if length.unit == "units" else in_metres(length.value, length.unit)
