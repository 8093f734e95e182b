"""What the page is told of a session besides its Gaussians: things, selection, the open question, history, welcome."""

from __future__ import annotations

import math
import re
import zlib
from collections.abc import Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np
import torch
from numpy.typing import NDArray

from ...gaussians.cloud import NO_GROUP
from ...gaussians.color import lab_to_rgb
from ...gaussians.color import name_of as color_name
from ...gaussians.kept import Kept
from ...gaussians.render.convention import near_plane
from ...gaussians.rows import rows_of_ids
from ...gaussians.world.box import Box
from ..pictures.named_cameras import framed
from ..session.pointing import whole_groups
from .slots import ranges_of

if TYPE_CHECKING:
    from ...gaussians.camera import Camera, Vec3
    from ...gaussians.language.field.language_field import Group, LanguageField
    from ...gaussians.language.query.selection import Candidate
    from ...gaussians.motion.motion import Motion
    from ...gaussians.scene import Scene
    from ...tools.receipt import Receipt
    from ..session.session import Session
    from .changes import Shown

_GROUP = re.compile(r" \(group \d+\)")  # as `Candidate.describe` writes it
HISTORY = 200  # steps that are told
_BOUNDS = 0.01  # share of the centres on each side that may lie outside the bounds of a scene: floaters
_SAMPLE = 20_000  # Gaussians from which the box of a selection is measured


def of(session: Session, shown: Shown) -> dict[str, Any]:
    """The fields of a `state` message but `busy`."""
    states = session.states
    return {
        "revision": shown.revision,
        "digest": session.digest,
        "things": _things(shown.scene.language) if shown.scene.language is not None else [],
        "selection": _selection(session, shown),
        "question": _question(session),
        "history": [{"text": s.text, "summary": _summary(s.receipts)} for s in states[1:][-HISTORY:]],
        "can_undo": len(states) > 1,
        "can_redo": session.redoable,
        "embedded": shown.scene.language is not None,
        "motion": span(shown.scene.motion),
    }


def _summary(receipts: Sequence[Receipt]) -> str:
    return "; ".join(r.sentence() for r in receipts)


def welcome(session: Session, title: str) -> dict[str, Any]:
    """The fields of a `welcome` message that no edit changes."""
    return about(session.scene, session.viewer, title)


def about(scene: Scene, camera: Camera, title: str) -> dict[str, Any]:
    """What a page must know of a scene to show it from a camera: title, frame, near plane, bounds."""
    frame = framed(scene).frame
    means = scene.cloud.means.numpy()
    ends = [np.zeros(3), np.ones(3)]
    if len(means):
        part = means[:: max(1, len(means) // _SAMPLE)]
        ends = list(np.quantile(part, [_BOUNDS, 1 - _BOUNDS], axis=0))
    return {
        "title": title,
        "up": list(frame.up),
        "floor": frame.floor,
        "metres_per_unit": frame.metres_per_unit,
        "near": near_plane(means),
        "bounds": [[float(c) for c in end] for end in ends],
        "camera": camera_json(camera),
    }


def camera_json(camera: Camera) -> dict[str, Any]:
    """A camera as the page has it."""
    return {
        "position": camera.position.tolist(),
        "forward": camera.forward.tolist(),
        "up": (-camera.world_to_camera[1, :3]).tolist(),
        "fov_y": math.degrees(2 * math.atan(camera.height / 2 / camera.fy)),
        "width": camera.width,
        "height": camera.height,
    }


_versions: Kept[int] = Kept(4)


def span(motion: Motion | None) -> dict[str, float] | None:
    """The `motion` of a `state` message: when it begins and ends, and a number that tells it from others; None for a
    static scene."""
    if motion is None:
        return None
    version = _versions.get((motion,), lambda: _version(motion))
    return {"start": motion.start, "stop": motion.stop, "version": version}


def _version(motion: Motion) -> int:
    """CRC-32 of all that a motion holds."""
    said = 0
    for part in (*motion.tracks, *motion.looks, *motion.residuals):
        for value in vars(part).values():
            data = np.asarray(value).tobytes() if isinstance(value, np.ndarray | torch.Tensor) else repr(value).encode()
            said = zlib.crc32(data, said)
    return said


@lru_cache(maxsize=2)
def _things(field: LanguageField) -> list[dict[str, Any]]:
    """The objects and structures that still have Gaussians."""
    return [
        {"group": g.id, "name": name_of(g), "color": _hex(g.lab), "box": box_json(g.box), "rows": g.count}
        for g in field.groups
        if g.count and g.parent < 0
    ]


def names(scene: Scene) -> dict[int, str]:
    """The names of the things that have Gaussians, by group; empty without a language field."""
    if scene.language is None:
        return {}
    return {g.id: name_of(g) for g in scene.language.groups if g.count and g.parent < 0}


def name_of(group: Group) -> str:
    """The name of a thing as the page shows it; where that is not sure, its colour: "gray thing"."""
    from ..terminal.thing_names import NAME_THRESHOLD

    sure = group.label and group.label_score >= NAME_THRESHOLD
    return group.label if sure else f"{color_name(group.lab)} thing"


@lru_cache(maxsize=4096)
def _hex(lab: Vec3) -> str:
    rgb = (lab_to_rgb(torch.tensor(lab)).clamp(0, 1) * 255).round().int().tolist()
    return "#{:02x}{:02x}{:02x}".format(*rgb)


def box_json(box: Box) -> dict[str, Any]:
    """A box with its axes as a unit quaternion wxyz, which turns the world's axes into its own."""
    quat = _quaternion(np.array(box.axes).T)
    return {"centre": list(box.center), "size": list(box.size), "quat": [float(c) for c in quat]}


def _quaternion(turn: NDArray[np.float64]) -> NDArray[np.float64]:
    """The unit quaternion wxyz of a rotation `[3, 3]`: the eigenvector of the matrix of Bar-Itzhack (2000)."""
    (a, b, c), (d, e, f), (g, h, i) = turn
    k = np.array(
        [[a - e - i, d + b, g + c, h - f], [d + b, e - a - i, h + f, c - g],
         [g + c, h + f, i - a - e, d - b], [h - f, c - g, d - b, a + e + i]]
    )  # fmt: skip
    x, y, z, w = np.linalg.eigh(k)[1][:, -1]
    return np.array([w, x, y, z]) * (1 if w >= 0 else -1)


def _selection(session: Session, shown: Shown) -> dict[str, Any]:
    """What "it" refers to: whole things, or ranges of slots with their box."""
    nothing: dict[str, Any] = {"groups": [], "ranges": [], "text": "", "box": None}
    last, scene = session.last, shown.scene
    if last is None or not len(last):
        return nothing
    rows = rows_of_ids(scene.cloud.ids, last.ids)
    if not len(rows):
        return nothing
    field = scene.language
    groups = [g for g in whole_groups(scene, rows) if field is not None and field.groups[g].parent < 0]
    if field is not None and sum(field.groups[g].count for g in groups) == len(rows):
        text = ", ".join(name_of(field.groups[g]) for g in groups[:4]) + (", …" if len(groups) > 4 else "")
        return {"groups": groups, "ranges": [], "text": text, "box": None}
    from ...gaussians.language.field.measure import box_of

    slots = np.sort(shown.slots.slot[rows.numpy()])
    box = box_of(scene.cloud[rows[:: max(1, len(rows) // _SAMPLE)]], scene.frame)
    owner = np.unique(shown.owner[scene.cloud.group[rows].numpy() - NO_GROUP])
    text = f"{len(rows):,} Gaussians"
    if field is not None and len(owner) == 1 and owner[0] >= 0:
        text += f" of the {name_of(field.groups[owner[0]])}"
    return {"groups": [], "ranges": ranges_of(slots).tolist(), "text": text, "box": box_json(box)}


def _question(session: Session) -> dict[str, Any] | None:
    asked = session.question
    if asked is None or not asked.candidates:
        return None
    candidates = [
        {"number": i, "group": c.group, "name": c.name, "centre": list(c.center)}
        for i, c in enumerate(asked.candidates, start=1)
    ]
    text = numbered(asked.selection.reason, asked.candidates)
    return {"kind": asked.selection.verdict, "text": text, "candidates": candidates}


def numbered(text: str, candidates: Sequence[Candidate]) -> str:
    """A text that lists candidates, with their numbers in the picture; the page shows no numbers of groups."""
    for number, candidate in enumerate(candidates, start=1):
        if candidate.group >= 0:
            text = text.replace(candidate.describe(), f"{candidate.name} ({number})", 1)
    return _GROUP.sub("", text)
