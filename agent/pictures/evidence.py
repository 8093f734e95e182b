"""Draws what an answer rests on: things outlined and named, distances and routes as labelled lines."""

from __future__ import annotations

import unicodedata
from collections import Counter
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from ...gaussians.camera import Camera
from ...gaussians.errors import UserError
from ...gaussians.motion.at import at
from ...gaussians.scene import Scene
from ...gaussians.viewpoints.for_groups import Sights, choose
from ...gaussians.viewpoints.view_candidates import View, plan
from ...gaussians.world.support import SHELL
from ...planners.questions.answer import Answer, Line
from ...planners.rooms.read_scene import RoomFrame
from ..terminal.thing_names import NAME_THRESHOLD
from .image_files import encoded_png
from .marked_views import Drawing, draw_view
from .marks import INK, Mark, Picture, Placed, color_of, draw_placed, free_place, half_size, outlined, place, visible
from .plan_view import with_grid, with_scale_bar, with_viewer

F64 = NDArray[np.float64]

SIZE = (960, 640)  # pixels, by default
SMALL = (768, 512)  # pixels, beside an answer in a conversation
ON_FLOOR = 0.15  # metres up to which a line lies on the floor and is shown on a plan
NEAR = 0.02  # of the scene's extent: lines are cut this far before the eye
MOST_NAMES = 16  # things up to which names are drawn; more get numbers
LONGEST = 28  # characters of a name
LINE = (255, 214, 10)
MAIN = (255, 176, 0)  # colour of what the answer names first


def evidence_picture(
    scene: Scene, answer: Answer, camera: Camera | None = None, size: tuple[int, int] = SIZE,
    viewer: Camera | None = None,
) -> Picture:  # fmt: skip
    """The picture of an answer's evidence.

    Routes, floors and rooms are drawn on a plan; everything else in the view that shows the things best. What an answer
    says of a moment of a scene with time is shown as it is then.

    Args:
        scene: the scene that was asked about, with its language field.
        camera: the view to draw into; None chooses one.
        size: of the picture where no camera is given, pixels.
        viewer: whose position a plan shows.

    Returns:
        `[H, W, 3]` uint8.

    Raises:
        UserError: the scene has no language field, or the answer is about another scene.
    """
    if answer.evidence.time is not None:
        scene = at(scene, answer.evidence.time)
    sights = Sights.of(scene)
    groups = _groups(scene, answer)
    room = RoomFrame(scene)
    lines = answer.evidence.lines
    ends = np.array([[room.world(line.start), room.world(line.end)] for line in lines]).reshape(-1, 2, 3)
    flat = all(max(line.start[2], line.end[2]) <= ON_FLOOR for line in lines)
    above = camera is None and (not groups or bool(len(ends))) and flat
    view = plan(scene, groups, size, sights.space) if above else _view(sights, groups, camera, size)
    drawing = draw_view(scene, view.camera, groups, view.cut)
    if above:
        gridded, step = with_grid(scene, sights, drawing)
        image = with_scale_bar(gridded, view.camera, sights, step)
        image = with_viewer(image, view.camera, viewer, sights) if viewer is not None else image
        drawing = Drawing(image, drawing.labels, view.camera)
    reach = float(np.linalg.norm(sights.space.high - sights.space.low))
    return _annotated(drawing, name_marks(scene, groups), ends, lines, NEAR * reach)


def has_picture(answer: Answer) -> bool:
    """Whether an answer rests on things or distances that can be drawn."""
    return bool(answer.evidence.ids or answer.evidence.lines)


def evidence_png(scene: Scene, answer: Answer, viewer: Camera) -> bytes:
    """`evidence_picture` at `SMALL`, as the bytes of a PNG file."""
    return encoded_png(evidence_picture(scene, answer, size=SMALL, viewer=viewer))


def _groups(scene: Scene, answer: Answer) -> tuple[int, ...]:
    """The groups that an answer is about, without floor, walls and ceiling; raises UserError if it is about another
    scene."""
    assert scene.language is not None
    table, found = scene.language.groups, list[int]()
    for i in answer.evidence.ids:
        if i in SHELL:
            continue
        if not isinstance(i, int) or i >= len(table) or not table[i].count:
            raise UserError(f"the answer is about thing {i!r}, which this scene does not have; ask again on this scene")
        found.append(i)
    return tuple(dict.fromkeys(found))


def _view(sights: Sights, groups: Sequence[int], camera: Camera | None, size: tuple[int, int]) -> View:
    if camera is not None:
        return View(camera.name or "given", "camera", camera)
    chosen = choose(sights, groups, 1, size)
    return chosen[0].view if chosen else plan(sights.scene, groups, size, sights.space)


def name_marks(scene: Scene, groups: Sequence[int]) -> tuple[Mark, ...]:
    """Names of things, numbered where several have one name; numbers where they are many."""
    assert scene.language is not None
    table = scene.language.groups
    colors = [MAIN if i == 0 else color_of(i) for i in range(len(groups))]
    if len(groups) > MOST_NAMES:
        return tuple(Mark(str(i), c) for i, c in enumerate(colors, start=1))
    names = [_plain(table[g].label) if table[g].label_score >= NAME_THRESHOLD else "" for g in groups]
    names = [n or f"thing {g}" for n, g in zip(names, groups, strict=True)]
    total, seen = Counter(names), Counter[str]()
    marks = []
    for name, color in zip(names, colors, strict=True):
        seen[name] += 1
        marks.append(Mark(f"{name} {seen[name]}" if total[name] > 1 else name, color))
    return tuple(marks)


def _plain(label: str) -> str:
    """A label without control characters, cut to `LONGEST`."""
    return "".join(c for c in label if unicodedata.category(c)[0] != "C")[:LONGEST].strip()


def _annotated(drawing: Drawing, marks: Sequence[Mark], ends: F64, lines: Sequence[Line], near: float) -> Picture:
    """The drawing with outlines, then lines, then names and lengths on top."""
    shown = visible(drawing.labels, len(marks))
    image = outlined(drawing.image, drawing.labels, [m.color for m in marks], shown)
    segments = [segment(drawing.camera, a, b, near) for a, b in ends]
    image = _with_lines(image, [s for s in segments if s is not None])
    placed = list(place(drawing.labels, marks, shown))
    image = draw_placed(image, marks, placed)
    labelled = _with_room(lines, segments, drawing.image.shape[0])
    return draw_placed(image, *_placed_lengths(labelled, drawing, placed))


def _with_room(lines: Sequence[Line], segments: Sequence[F64 | None], height: int) -> list[tuple[str, F64]]:
    """The labels that are drawn, with their segments; on a route only those of legs that are longer than the label."""
    found = []
    for i, (line, s) in enumerate(zip(lines, segments, strict=True)):
        if s is None or not line.label:
            continue
        leg = any(line.start == other.end or line.end == other.start for k, other in enumerate(lines) if k != i)
        if not leg or float(np.linalg.norm(s[1] - s[0])) > 2 * half_size(line.label, height)[0]:
            found.append((_plain(line.label), s))
    return found


def _placed_lengths(
    labelled: Sequence[tuple[str, F64]], drawing: Drawing, names: Sequence[Placed]
) -> tuple[list[Mark], list[Placed]]:
    """Labels at the middles of their segments, beside those that they would cover, and clear of names."""
    nothing = np.full_like(drawing.labels, -1)
    marks, spots = list[Mark](), list[Placed]()
    for text, s in labelled:
        half = half_size(text, drawing.image.shape[0])
        middle = (float(s[:, 0].mean()), float(s[:, 1].mean()))
        room = max(half) if float(np.linalg.norm(s[1] - s[0])) > 3 * half[0] else 0.0
        at = free_place(nothing, -1, middle, room, half, [*names, *spots])
        spots.append(Placed(len(marks), at, middle, half))
        marks.append(Mark(text, LINE))
    return marks, spots


def segment(camera: Camera, start: F64, end: F64, near: float) -> F64 | None:
    """A world segment in pixels `[2, 2]`, cut at depth `near` and at the border of the image; None if out of sight."""
    rotation, shift = camera.world_to_camera[:3, :3], camera.world_to_camera[:3, 3]
    a, b = rotation @ start + shift, rotation @ end + shift
    near = max(near, 1e-6 * float(np.abs([a, b]).max()))
    if max(a[2], b[2]) <= near:
        return None
    if a[2] < near:
        a = b + (a - b) * (b[2] - near) / (b[2] - a[2])
    elif b[2] < near:
        b = a + (b - a) * (a[2] - near) / (a[2] - b[2])
    points = np.array([[camera.fx * p[0] / p[2] + camera.cx, camera.fy * p[1] / p[2] + camera.cy] for p in (a, b)])
    return _within(points, camera.width, camera.height)


def _within(points: F64, width: int, height: int) -> F64 | None:
    """The part of a segment `[2, 2]` that lies in the image (Liang and Barsky 1984), or None."""
    way = points[1] - points[0]
    enter, leave = 0.0, 1.0
    for axis, limit in ((0, width), (1, height)):
        for sign, bound in ((-1.0, 0.0), (1.0, float(limit))):
            speed, room = sign * way[axis], sign * (bound - points[0, axis])
            if abs(speed) < 1e-12:
                if room < 0:
                    return None
            elif speed < 0:
                enter = max(enter, room / speed)
            else:
                leave = min(leave, room / speed)
    return np.stack([points[0] + enter * way, points[0] + leave * way]) if enter <= leave else None


def _with_lines(image: Picture, segments: Sequence[F64]) -> Picture:
    canvas = Image.fromarray(np.ascontiguousarray(image))
    draw = ImageDraw.Draw(canvas)
    width = max(3, image.shape[0] // 180)
    for color, wide in ((INK, width + 2), (LINE, width)):
        for (x0, y0), (x1, y1) in segments:
            draw.line((x0, y0, x1, y1), fill=color, width=wide)
    for s in segments:
        for x, y in s:
            draw.ellipse((x - width, y - width, x + width, y + width), fill=LINE, outline=INK)
    return np.asarray(canvas)
