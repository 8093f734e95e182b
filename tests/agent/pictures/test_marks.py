"""Numbered marks, plans and pictures of evidence: where they are drawn, checked against what the pixels show."""

from __future__ import annotations

import numpy as np
import pytest
from boxed_room import Thing, room, shell

from scenewright.agent.pictures.evidence import evidence_picture, name_marks, segment
from scenewright.agent.pictures.marked_views import draw_view
from scenewright.agent.pictures.marks import color_of, draw_marks, numbered_marks, outline, place, visible
from scenewright.agent.pictures.plan_view import draw_plan
from scenewright.gaussians.camera import Camera
from scenewright.gaussians.errors import UserError
from scenewright.gaussians.scene import Scene
from scenewright.gaussians.viewpoints.for_groups import Sights
from scenewright.planners.questions.answer import Answer, Evidence, Line
from scenewright.planners.rooms.read_scene import RoomFrame

RED, BLUE, PIN = 6, 7, 8


@pytest.fixture(scope="module")
def scene() -> Scene:
    return room(
        [
            *shell(),
            Thing("box", (-1.5, 0.0, 0.0), (-0.7, 0.8, 0.7), (0.9, 0.05, 0.05)),
            Thing("box", (0.7, 0.0, 0.0), (1.5, 0.8, 0.7), (0.05, 0.05, 0.9)),
            Thing("pin", (-0.03, 0.4, 0.5), (0.03, 0.46, 0.56), (0.9, 0.9, 0.1), step=0.02),
        ]
    )


@pytest.fixture(scope="module")
def camera() -> Camera:
    return Camera.look_at([0, -1.9, 1.4], [0, 0.4, 0.4], [0, 0, 1], 480, 320, 60)


def _answer(ids: tuple[int, ...], *lines: Line) -> Answer:
    return Answer(answer="yes", answer_type="yesno", text="yes", evidence=Evidence(ids=ids, lines=lines))


def test_a_large_thing_is_marked_on_its_own_pixels_and_a_small_one_beside_them(scene: Scene, camera: Camera) -> None:
    drawing = draw_view(scene, camera, [RED, BLUE, PIN])
    placed = {p.index: p for p in place(drawing.labels, numbered_marks(3), visible(drawing.labels, 3))}
    assert set(placed) == {0, 1, 2}
    for i in (0, 1):
        assert drawing.labels[int(placed[i].at[1]), int(placed[i].at[0])] == i
        assert placed[i].at == placed[i].anchor
    pin = placed[2]
    assert drawing.labels[int(pin.anchor[1]), int(pin.anchor[0])] == 2
    assert max(abs(pin.at[0] - pin.anchor[0]) - pin.half[0], abs(pin.at[1] - pin.anchor[1]) - pin.half[1]) > 0


def test_marks_do_not_overlap_and_stay_in_the_picture() -> None:
    labels = np.full((240, 320), -1, np.int32)
    for i in range(12):  # twelve things side by side, each smaller than its mark
        labels[120:128, 100 + 9 * i : 107 + 9 * i] = i
    placed = place(labels, numbered_marks(12), visible(labels, 12))
    assert len(placed) == 12
    for a in placed:
        assert a.half[0] <= a.at[0] <= 320 - a.half[0] and a.half[1] <= a.at[1] <= 240 - a.half[1]
    apart = [
        max(abs(a.at[0] - b.at[0]) / (a.half[0] + b.half[0]), abs(a.at[1] - b.at[1]) / (a.half[1] + b.half[1]))
        for k, a in enumerate(placed)
        for b in placed[:k]
    ]
    assert min(apart) >= 0.7  # rounded plates may touch at their corners


def test_what_is_hidden_has_no_mark(scene: Scene) -> None:
    behind = Camera.look_at([0, -1.9, 1.0], [0, -3, 1.0], [0, 0, 1], 240, 160, 60)
    drawing = draw_view(scene, behind, [RED, BLUE])
    image, placed = draw_marks(drawing.image, drawing.labels, numbered_marks(2))
    assert placed == () and np.array_equal(image, drawing.image)


def test_marks_and_outlines_leave_the_rest_of_the_picture_as_it_is(scene: Scene, camera: Camera) -> None:
    drawing = draw_view(scene, camera, [RED, BLUE])
    marked, placed = draw_marks(drawing.image, drawing.labels, numbered_marks(2))
    changed = (marked != drawing.image).any(axis=2)
    assert 0.005 < changed.mean() < 0.06
    plain, _ = draw_marks(drawing.image, drawing.labels, numbered_marks(2), outlines=False)
    assert (plain != drawing.image).any(axis=2).sum() < changed.sum()
    again, same = draw_marks(drawing.image, drawing.labels, numbered_marks(2))
    assert np.array_equal(again, marked) and same == placed


def test_an_outline_lies_along_the_border() -> None:
    mask = np.zeros((40, 40), bool)
    mask[10:30, 10:30] = True
    drawn = outline(np.zeros((40, 40, 3), np.uint8), mask, (255, 0, 0), 2)
    lit = drawn[..., 0] == 255
    assert lit[10, 10:30].all() and lit[9, 10:30].all() and not lit[20, 20] and not lit[5].any()
    assert lit.sum() == 2 * 80 - 4


def test_neighbouring_numbers_differ_in_colour() -> None:
    colors = np.array([color_of(i) for i in range(1, 30)], dtype=float)
    assert np.linalg.norm(np.diff(colors, axis=0), axis=1).min() > 80
    assert len({color_of(i) for i in range(1, 60)}) == 59


def test_a_plan_shows_things_where_they_stand(scene: Scene) -> None:
    plan = draw_plan(Sights.of(scene), [RED, BLUE], numbered_marks(2), (400, 300), outlines=False)
    assert plan.numbers == (0, 1) and plan.step == 0.5
    (red, blue), _ = plan.view.camera.project(np.array([[-1.1, 0.4, 0.7], [1.1, 0.4, 0.7]]))
    assert red[0] < blue[0] and abs(red[1] - blue[1]) < 2
    for (x, y), channel in ((red, 0), (blue, 2)):
        pixel = plan.image[int(y) - 18, int(x)].astype(int)  # beside the mark
        assert pixel[channel] > 150 and pixel[2 - channel] < 90
    # A metre on the floor is as long across as along.
    ends, _ = plan.view.camera.project(np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]))
    across, along = np.linalg.norm(ends[1:] - ends[0], axis=1)
    assert across == pytest.approx(along, rel=1e-6)


def test_a_plan_shows_the_viewer(scene: Scene, camera: Camera) -> None:
    sights = Sights.of(scene)
    without = draw_plan(sights, [], (), (400, 300)).image
    with_viewer = draw_plan(sights, [], (), (400, 300), camera)
    changed = np.argwhere((with_viewer.image != without).any(axis=2))
    ((x, y),), _ = with_viewer.view.camera.project(np.array([[0.0, -1.9, 0.0]]))
    assert np.abs(changed - [y, x]).max(axis=1).min() < 3
    assert changed[:, 0].mean() < y + 1  # the arrow points up, where the viewer looks


def test_segments_are_cut_before_the_eye_and_at_the_border(camera: Camera) -> None:
    through = segment(camera, np.array([0, 0.4, 0.4]), np.array([0, -9, 1.4]), 0.05)
    assert through is not None and np.isfinite(through).all()
    assert (through >= -1e-6).all() and (through[:, 0] <= 480 + 1e-6).all() and (through[:, 1] <= 320 + 1e-6).all()
    assert segment(camera, np.array([0.0, -5, 1]), np.array([0.0, -9, 1]), 0.05) is None
    inside = segment(camera, np.array([-0.2, 0.4, 0.4]), np.array([0.2, 0.4, 0.4]), 0.05)
    pixels, _ = camera.project(np.array([[-0.2, 0.4, 0.4], [0.2, 0.4, 0.4]]))
    assert inside is not None and np.allclose(inside, pixels)


def test_a_distance_is_drawn_between_its_ends(scene: Scene, camera: Camera) -> None:
    frame = RoomFrame(scene)
    ends = np.array([[-0.7, 0.4, 0.6], [0.7, 0.4, 0.6]])
    line = Line(start=frame.point(ends[0]), end=frame.point(ends[1]), label="1.40 m")
    assert np.allclose(frame.world(line.start), ends[0])
    with_line = evidence_picture(scene, _answer((RED, BLUE), line), camera)
    without = evidence_picture(scene, _answer((RED, BLUE)), camera)
    changed = (with_line != without).any(axis=2)
    (a, b), _ = camera.project(ends)
    for t in (0.1, 0.3, 0.7, 0.9):
        x, y = a + t * (b - a)
        assert changed[int(y), int(x)]
    assert changed[: int(a[1]) - 40].sum() == 0  # nothing else changes


def test_a_route_is_drawn_on_a_plan_and_things_alone_are_not(scene: Scene) -> None:
    route = [Line(start=(-1, -1, 0.0), end=(0, -1, 0.0)), Line(start=(0, -1, 0.0), end=(1, -1, 0.0), label="2.0 m")]
    plan = evidence_picture(scene, _answer((RED, BLUE), *route), size=(400, 300))
    bare = draw_plan(Sights.of(scene), [RED, BLUE], (), (400, 300)).image
    assert (plan == bare).all(axis=2).mean() > 0.85  # the same view, but for names and the route
    seen = evidence_picture(scene, _answer((RED, BLUE)), size=(400, 300))
    assert (seen == bare).all(axis=2).mean() < 0.5


def test_things_are_named_and_told_apart(scene: Scene) -> None:
    assert [m.text for m in name_marks(scene, [RED, BLUE, PIN])] == ["box 1", "box 2", "pin"]
    assert len({m.color for m in name_marks(scene, [RED, BLUE, PIN])}) == 3


def test_an_answer_about_another_scene_is_refused(scene: Scene) -> None:
    for wrong in (99, "kettle"):
        answer = Answer(answer="yes", answer_type="yesno", text="yes", evidence=Evidence(ids=(wrong,)))
        with pytest.raises(UserError, match="does not have"):
            evidence_picture(scene, answer)


def test_an_answer_about_the_floor_has_a_picture(scene: Scene) -> None:
    answer = Answer(answer=None, answer_type="label", text="Nothing tells its colour.", source="none",
                    evidence=Evidence(ids=("floor", RED)))  # fmt: skip
    assert evidence_picture(scene, answer, size=(400, 300)).shape == (300, 400, 3)


def test_short_legs_of_a_route_have_no_label_and_a_label_beside_a_short_line_leaves_it_visible(
    scene: Scene, camera: Camera
) -> None:
    def drawn(*lines: Line) -> np.ndarray:
        return evidence_picture(scene, _answer((), *lines), camera).astype(int)

    far, near = (-1.0, -0.5, 0.0), (-0.95, -0.5, 0.0)
    short = {"start": far, "end": near}
    leg = Line(start=near, end=(1.0, -0.5, 0.0))
    assert np.array_equal(drawn(Line(**short, label="0.05 m"), leg), drawn(Line(**short), leg))
    alone = drawn(Line(**short, label="0.05 m"))
    frame = RoomFrame(scene)
    (a, b), _ = camera.project(np.array([frame.world(far), frame.world(near)]))
    bare = drawn(Line(**short))
    x, y = (a + b) / 2
    at = (slice(int(y) - 2, int(y) + 3), slice(int(x) - 2, int(x) + 3))
    assert (bare[at] != evidence_picture(scene, _answer(()), camera).astype(int)[at]).any()
    assert (alone != bare).any()
    assert (np.abs(alone[at] - [255, 214, 10]).sum(axis=2) < 30).any()  # the line's own yellow
