"""Moves the viewer of a session as words ask for it; `camera_words` reads the words."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from .camera_words import CameraMove

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ...gaussians.camera import Camera
    from .session import Session

_TURNS = {"front": 0.0, "right": 90.0, "behind": 180.0, "left": -90.0}  # degrees from the first view
_HEIGHTS = {"above": 75.0, "below": -35.0}  # degrees above the horizon
_LEVEL = 5.0, 45.0  # degrees above the horizon, between which a view from a side stays
_MANY = 8  # cameras from which they are those of photographs
_NEARLY = 0.77  # cosine of about 40 degrees
_FACES = {"left": "the left", "right": "the right", "front": "the front"}


@dataclass(frozen=True, eq=False)
class Looked:
    """Where the camera is after its moves.

    Attributes:
        camera: the new viewer.
        told: the moves in words: "from the left of the first view, closer".
        notes: what could not be done exactly.
        pivot: `[3]`, world, the point that the camera moves around; None if that is what it looks at now.
        up: `[3]`, unit, world; kept, as it takes seconds to estimate where the file does not give it.
    """

    camera: Camera
    told: str
    notes: tuple[str, ...] = ()
    pivot: NDArray[np.float64] | None = None
    up: NDArray[np.float64] | None = None


def look(session: Session, moves: Sequence[CameraMove], home: Camera, before: Looked | None = None) -> Looked:
    """The camera after these moves of the session's viewer; the viewer itself stays.

    Args:
        home: the first view, whose left, right, front and back are meant.
        before: the moves that led to the viewer, so that an orbit in steps stays around one point.

    Raises:
        UserError, InstructionError: a thing that is named is not there, not understood, or cannot be seen.
    """
    from ..pictures.named_cameras import framed

    told: list[str] = []
    notes: list[str] = []
    now = before if before is not None and before.camera is session.viewer else Looked(session.viewer, "")
    known = before.up if before is not None else None
    up = known if known is not None else framed(session.scene).frame.up_vector
    for move in moves:
        if move.kind == "thing":
            now = _at_thing(session, move, now.camera)
        elif move.kind == "home":
            now = Looked(home, "the first view")
        elif move.kind == "side":
            now = _from_side(session, move, now.camera, home, up)
        else:
            now = _moved(session, move, now, up)
        told.append(now.told)
        notes.extend(now.notes)
    if _unseen(session, now.camera):
        notes.append("no photograph was taken from about there, so what is shown there is uncertain")
    return replace(now, told=", ".join(told), notes=tuple(dict.fromkeys(notes)), up=up)


def _unseen(session: Session, camera: Camera) -> bool:
    """Whether the scene comes with its photographs' cameras, and none of them looks nearly the same way."""
    cameras = session.scene.cameras
    return len(cameras) >= _MANY and max(float(c.forward @ camera.forward) for c in cameras) < _NEARLY


def _from_side(session: Session, move: CameraMove, camera: Camera, home: Camera, up: NDArray[np.float64]) -> Looked:
    from ...gaussians.viewpoints.moving import from_azimuth_of, orbited, pivot_of, with_clear_sight

    pivot = pivot_of(session.scene, home)
    start = orbited(home, pivot, up)
    if move.side in _HEIGHTS:
        asked = orbited(start, pivot, up, to=_HEIGHTS[move.side], azimuth=from_azimuth_of(start, camera, up, 0.0))
        told = f"from {move.side}"
    else:
        height = min(max(_elevation(start, pivot, up), _LEVEL[0]), _LEVEL[1])
        asked = orbited(start, pivot, up, azimuth=_TURNS[move.side], to=height)
        told = f"from {_FACES.get(move.side, move.side)}, as seen in the first view"
    clear, free = with_clear_sight(session.scene, asked, pivot)
    return Looked(clear, told, () if free else ("something stands in the way from there",), pivot)


def _moved(session: Session, move: CameraMove, now: Looked, up: NDArray[np.float64]) -> Looked:
    from ...gaussians.viewpoints.moving import facing_point, nearer, orbited, pivot_of, turned

    camera = now.camera
    if move.kind == "turn":
        way = ("left" if move.azimuth > 0 else "right") if move.azimuth else ("up" if move.upward > 0 else "down")
        return Looked(turned(camera, up, left=move.azimuth, upward=move.upward), f"turned {way}")
    if move.words:
        pivot = _middle(session, move.words)
        camera = facing_point(camera, pivot, up)
    else:
        pivot = now.pivot if now.pivot is not None else pivot_of(session.scene, camera)
    if move.kind == "nearer":
        told = ("closer" if move.share < 1 else "farther away") + (f" to {move.words}" if move.words else "")
        return Looked(nearer(camera, pivot, move.share), told, pivot=pivot)
    told = f"{abs(move.azimuth):g} degrees around {move.words or 'what is in the middle'}"
    if move.upward:
        told = "higher" if move.upward > 0 else "lower"
    moved = orbited(camera, pivot, up, azimuth=move.azimuth, elevation=move.upward)
    return Looked(moved, told, pivot=pivot)


def _at_thing(session: Session, move: CameraMove, camera: Camera) -> Looked:
    from .find_view import find_view

    found = find_view(session, move.words, (camera.width, camera.height))
    return Looked(found.view.camera, f"looking at {move.words}", found.notes)


def _middle(session: Session, words: str) -> NDArray[np.float64]:
    """`[3]`, the middle of the things that a phrase names. Raises as `look`."""
    import numpy as np

    found = session.select(words)
    if not found.chosen:
        found.require()
    return np.mean([c.center for c in found.candidates], axis=0, dtype=np.float64)


def _elevation(camera: Camera, pivot: NDArray[np.float64], up: NDArray[np.float64]) -> float:
    """Degrees above the horizon at which the camera stands, seen from the pivot."""
    import numpy as np

    offset = camera.position - pivot
    return float(np.degrees(np.arcsin(np.clip(offset @ up / np.linalg.norm(offset), -1, 1))))
