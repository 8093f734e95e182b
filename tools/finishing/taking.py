"""Take the texture of another thing, or of a photograph, for a surface that is to look like it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from ...gaussians.color import Rgb, shade_of
from ...gaussians.errors import InstructionError
from ...gaussians.language.query.query import Query
from ...gaussians.language.query.selection import Selection
from ...gaussians.scene import Scene
from ...gaussians.world.finishes import Finish
from ..operation import Context
from ..placement.bodies import bodies_of
from .design import Choice, Design, Lit, of_exemplar, of_finish
from .exemplar import Exemplar, Picture, exemplar_of
from .photograph import Photograph, named
from .sampled import texture_of

_ALIKE = 14.0  # Lab distance up to which several things of one name have one pattern
_WIDTH = 1.0  # metres that a photograph is taken to show, where nothing tells its size


@dataclass(frozen=True, eq=False)
class Taken:
    """What was taken from a thing or a photograph.

    Attributes:
        exemplar: the texture; None if only the colour was taken, for the finish that was said.
        color: the colour of a plain surface, for that finish.
        in_units: whether lengths of the texture are scene units; metres otherwise.
        notes: for the receipt.
        ids: ids of the Gaussians that it was taken from.
    """

    exemplar: Exemplar | None
    color: Rgb | None
    in_units: bool
    notes: tuple[str, ...]
    ids: frozenset[int] = frozenset()

    def design(self, finish: Finish | None, choice: Choice, metres: float) -> Design:
        """What is painted, in a scene of so many metres a unit.

        Raises:
            UserError: a colour is unknown.
        """
        if self.exemplar is None:
            assert finish is not None and self.color is not None
            own = f"#{''.join(f'{round(255 * c):02x}' for c in self.color)}"
            return of_finish(finish, Choice(choice.color or own, choice.second, choice.unit, choice.seed), self.color)
        texture = self.exemplar.scaled(metres) if self.in_units else self.exemplar
        if choice.unit is not None and texture.unit is not None:
            texture = texture.scaled(choice.unit / texture.unit)
        return of_exemplar(texture.colored(shade_of(choice.color)) if choice.color else texture)


def one_of_alike(scene: Scene, like: Query, context: Context) -> Selection:
    """The thing that a query means; of several of one name and nearly one colour the largest: they have one pattern.

    Raises:
        AbsentError, AmbiguousError, UnconfirmedError: as `Selection.require`.
    """
    found = context.resolve(scene, like)
    groups = [c.group for c in found.candidates]
    if found.verdict != "ambiguous" or scene.language is None or min(groups, default=-1) < 0:
        return found.require()
    rows = [scene.language.groups[g] for g in groups]
    apart = max(math.dist(a.lab, b.lab) for a in rows for b in rows)
    if len({row.label for row in rows}) > 1 or apart > _ALIKE:
        return found.require()
    largest = max(rows, key=lambda row: row.box.size[0] * row.box.size[1] * row.box.size[2])
    return context.resolve(scene, Query(groups=(largest.id,))).require()


def from_thing(scene: Scene, source: Selection, finish: Finish | None, unit: bool) -> Taken:
    """The texture of a thing; of several the largest.

    Args:
        finish: the material that it was said to be of: a plain or coarse thing gives only its colour to it.
        unit: whether a length for what repeats was said.

    Raises:
        InstructionError: too little of it can be seen to take a pattern from.
    """
    body = max(bodies_of(scene, source), key=lambda b: float(b.box.size[0] * b.box.size[1] * b.box.size[2]))
    name = source.query.text or body.label or "thing"
    ids = frozenset(source.ids.tolist())
    try:
        found = texture_of(scene, body, 1.0, name)
    except InstructionError:
        if finish is None:
            raise
        color = Lit.of(scene, body.rows).own
        return Taken(None, color, True, (f"the {name} is too coarse to show a pattern: its colour was taken",), ids)
    if not found.plain:
        told = (
            ("the length that was said was not used, as no pattern repeats there",) if unit and not found.unit else ()
        )
        return Taken(found, None, True, (_told(name, found), *told), ids)
    if finish is not None:
        said = f"the {name} shows no pattern: its colour was taken for {finish.name}"
        return Taken(None, found.mean, True, (said,), ids)
    return Taken(found, None, True, (f"the {name} shows no pattern, so its colour alone was taken",), ids)


def from_reference(
    name: str, given: Mapping[str, Photograph], width: float | None, finish: Finish | None, unit: bool
) -> Taken:
    """The texture that a photograph shows.

    Args:
        width: metres that it shows from left to right; None where that was not said.
        finish: the material that it was said to show, whose usual size counts where no other is known.
        unit: whether a length for what repeats was said.

    Raises:
        UserError: no such photograph was given.
    """
    photograph = named(name, given)
    width = width or photograph.width
    cell = (width or _WIDTH) / photograph.rgb.shape[1]
    texture = exemplar_of(Picture(photograph.rgb.astype("float64"), photograph.known, cell, lies=False))
    notes = list[str]()
    usual = finish.unit if finish is not None and finish.periodic else None
    if texture.unit is None and unit:
        notes.append(f"nothing repeats in {photograph.name}, so it was taken to be {width or _WIDTH:g} m wide")
    elif width is None and not unit and usual is not None and texture.unit is not None:
        texture = texture.scaled(usual / texture.unit)
        notes.append(f"{photograph.name} was sized so that the {finish and finish.name} repeats every {usual:g} m")
    elif width is None and not unit:
        notes.append(f"{photograph.name} was taken to show {_WIDTH:g} m from left to right; say how wide it is")
    return Taken(texture, None, False, tuple(notes))


def _told(name: str, found: Exemplar) -> str:
    repeats = " and ".join(f"{p:.2g}" for p in found.period if p is not None)
    return f"the pattern of the {name} was taken" + (f"; it repeats every {repeats} units" if repeats else "")
