"""Finds the view that a phrase asks for: "the guitar from behind", "what one sees sitting on the sofa"."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ...gaussians.errors import InstructionError
from ...planners.grammar.view_phrase import ViewRequest, read_view

if TYPE_CHECKING:
    from ...gaussians.viewpoints.for_groups import ChosenView, Sights
    from ...gaussians.viewpoints.from_side import SideView
    from ...gaussians.viewpoints.view_candidates import View
    from .session import Session

TURNED = 20.0  # degrees from the side that was asked for, from which the answer says so


@dataclass(frozen=True, eq=False)
class FoundView:
    """The view that a phrase asks for.

    Attributes:
        view: camera, and what is cut away so that it can see.
        groups: ids of the groups that are to be seen, in the order of the phrase; empty for the whole scene.
        shares: share of the picture that each of them covers, in [0, 1].
        notes: remarks in words: whose left and right is meant, and what could not be done exactly.
    """

    view: View
    groups: tuple[int, ...]
    shares: tuple[float, ...]
    notes: tuple[str, ...] = ()


def find_view(session: Session, phrase: str, size: tuple[int, int]) -> FoundView:
    """The view that `phrase` asks for, of `size` pixels; embeds the scene if needed.

    Raises:
        UserError: the phrase is empty, too long, or names things in words that are not understood.
        AbsentError, AmbiguousError: a thing that it names is not there, or several match. One that is chosen without
            confirmation is shown, and a note says so.
        InstructionError: the things cannot be seen from there.
    """
    asked = read_view(phrase)
    doubts: list[str] = []
    groups = _groups(session, asked.things, doubts)
    stand = _groups(session, asked.stand, doubts)
    found = _found(session, asked, groups, stand, size)
    return replace(found, notes=(*doubts, *found.notes))


def _found(
    session: Session, asked: ViewRequest, groups: tuple[int, ...], stand: tuple[int, ...], size: tuple[int, int]
) -> FoundView:
    from ...gaussians.viewpoints.for_groups import Sights

    sights = Sights.of(session.surroundings((*groups, *stand)))
    if stand:
        return _from_thing(sights, stand, groups, asked, size)
    if groups:
        return _of_things(sights, groups, asked, session, size)
    return _of_all(sights, asked, size)


def _groups(session: Session, words: str, doubts: list[str]) -> tuple[int, ...]:
    """The groups that a noun phrase means; raises as `find_view`. What is not confirmed is added to `doubts`."""
    if not words:
        return ()
    found = session.select(words)
    if found.verdict == "unconfirmed":
        doubts.append(found.reason)
    else:
        found.require()
    if not found.groups:
        raise InstructionError(f"{words!r} is no thing of its own here; name the whole thing")
    return tuple(dict.fromkeys(found.groups))


def _from_thing(
    sights: Sights, stand: tuple[int, ...], groups: tuple[int, ...], asked: ViewRequest, size: tuple[int, int]
) -> FoundView:
    from ...gaussians.viewpoints.from_side import view_from_thing

    if len(stand) > 1:
        raise InstructionError(f"{asked.stand!r} are {len(stand)} things; a view starts at one of them")
    found = view_from_thing(sights, stand[0], groups, size)
    if groups and not any(found.chosen.shares.values()):
        raise InstructionError(f"{asked.things} cannot be seen from {asked.stand}: something stands in the way")
    notes = [] if found.whose == "object" or groups else [f"{asked.stand} has no front; the view looks into the room"]
    return FoundView(found.chosen.view, groups, tuple(found.chosen.shares[g] for g in groups), tuple(notes))


def _of_things(
    sights: Sights, groups: tuple[int, ...], asked: ViewRequest, session: Session, size: tuple[int, int]
) -> FoundView:
    from ...gaussians.viewpoints.from_side import CLOSE, FAR, view_from_side

    distance = {"close": CLOSE, "far": FAR}.get(asked.distance or "", 1.0)
    found = view_from_side(
        sights, groups, asked.side, session.viewer, distance=distance, eye_level=asked.eye_level, size=size
    )
    return FoundView(found.chosen.view, groups, tuple(found.chosen.shares[g] for g in groups), _notes(found, asked))


def _of_all(sights: Sights, asked: ViewRequest, size: tuple[int, int]) -> FoundView:
    from ...gaussians.viewpoints.for_groups import choose
    from ...gaussians.viewpoints.view_candidates import plan

    if asked.side == "above":
        return FoundView(plan(sights.scene, (), size, sights.space), (), ())
    if asked.side is not None:
        raise InstructionError(f"the whole scene has no view from {asked.side}; name a thing, or say 'from above'")
    chosen: tuple[ChosenView, ...] = choose(sights, (), 1, size)
    if not chosen:
        raise InstructionError("nothing can be seen in this scene")
    return FoundView(chosen[0].view, (), ())


def _notes(found: SideView, asked: ViewRequest) -> tuple[str, ...]:
    notes = []
    if asked.side in ("front", "behind", "left", "right"):
        whose = "its own, away from its back" if found.whose == "object" else "the viewer's, as it has no front"
        notes.append(f"front, left and right are {whose}")
    if found.turned > TURNED:
        notes.append(f"about {found.turned:.0f} degrees from that side, where there is room and a clear sight")
    if found.chosen.view.cut:
        notes.append("what stands between is left out of the picture")
    return tuple(notes)
