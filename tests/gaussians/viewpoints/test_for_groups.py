"""Views chosen for groups: laws, the slow reference, and what the chosen views show."""

from __future__ import annotations

import numpy as np
import pytest
from boxed_room import Thing, room, shell

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.errors import UserError
from scenewright.gaussians.render import render
from scenewright.gaussians.scene import Scene
from scenewright.gaussians.viewpoints import for_groups
from scenewright.gaussians.viewpoints.for_groups import (
    Sights,
    choose,
    choose_all_rendered,
    choose_random,
    choose_uniform,
    readability,
)
from scenewright.gaussians.viewpoints.visibility import GroupPixels

RED, BLUE, SCREEN = 6, 7, 8  # groups after the six of the shell
SIZE = (240, 180)


@pytest.fixture(scope="module")
def scene() -> Scene:
    """A red box, a blue box at the other end, and a screen between them that is higher than eyes."""
    return room(
        [
            *shell(),
            Thing("box", (-1.5, -0.3, 0.0), (-0.9, 0.3, 0.6), (0.9, 0.05, 0.05)),
            Thing("box", (0.9, -0.3, 0.0), (1.5, 0.3, 0.6), (0.05, 0.05, 0.9)),
            Thing("screen", (-0.02, -1.4, 0.0), (0.02, 1.4, 1.9), (0.1, 0.7, 0.1)),
        ]
    )


@pytest.fixture(scope="module")
def sights(scene: Scene) -> Sights:
    return Sights.of(scene)


def _red_and_blue(scene: Scene, view: for_groups.ChosenView) -> tuple[float, float]:
    """Shares of red and of blue pixels, measured by colour alone."""
    image = render(view.view.cut.apply(scene), view.view.camera).to_uint8().astype(int)
    red = (image[..., 0] > 120) & (image[..., 1:] < 60).all(axis=2)
    blue = (image[..., 2] > 120) & (image[..., :2] < 60).all(axis=2)
    return float(red.mean()), float(blue.mean())


@pytest.mark.parametrize("groups", [(RED,), (RED, BLUE), ()])
def test_the_choice_is_that_of_the_reference_with_fewer_renders(
    sights: Sights, groups: tuple[int, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    rendered: list[Camera] = []
    shares = GroupPixels.shares
    monkeypatch.setattr(GroupPixels, "shares", lambda self, camera, cut=None: (
        rendered.append(camera), shares(self, camera, cut))[1])  # fmt: skip
    quick = choose(sights, groups, 3, SIZE)
    few = len(rendered)
    slow = choose_all_rendered(sights, groups, 3, SIZE)
    assert [v.view.name for v in quick] == [v.view.name for v in slow]
    assert few <= len(rendered) - few
    if groups:
        assert few < 0.8 * (len(rendered) - few)


def test_the_first_views_show_what_is_asked_for_by_its_colour_alone(scene: Scene, sights: Sights) -> None:
    red, _ = _red_and_blue(scene, choose(sights, [RED], 1, SIZE)[0])
    _, blue = _red_and_blue(scene, choose(sights, [BLUE], 1, SIZE)[0])
    assert red > 0.02 and blue > 0.02
    both = [_red_and_blue(scene, v) for v in choose(sights, [RED, BLUE], 2, SIZE)]
    assert max(r for r, _ in both) > 0.01 and max(b for _, b in both) > 0.01


def test_shares_agree_with_a_render_of_full_size(scene: Scene, sights: Sights) -> None:
    for view in choose(sights, [RED, BLUE], 3, SIZE):
        red, blue = _red_and_blue(scene, view)
        # Counted in images of 128 pixels; borders of a box are a pixel of them on each side.
        assert view.shares[RED] == pytest.approx(red, abs=0.02, rel=0.25)
        assert view.shares[BLUE] == pytest.approx(blue, abs=0.02, rel=0.25)


def test_every_eye_is_in_free_space_or_its_view_is_cut(scene: Scene, sights: Sights) -> None:
    for view in choose(sights, [RED, BLUE], 4, SIZE):
        eye = view.view.camera.position
        inside = abs(eye[0]) < 2 and abs(eye[1]) < 2 and 0 < eye[2] < 2.6
        assert inside or view.view.cut
        assert not (abs(eye[0]) < 0.02 and abs(eye[1]) < 1.4 and eye[2] < 1.9)


def test_choosing_twice_gives_the_same_and_more_views_extend_fewer(sights: Sights) -> None:
    two, three = choose(sights, [RED, BLUE], 2, SIZE), choose(sights, [RED, BLUE], 3, SIZE)
    assert [v.view.name for v in two] == [v.view.name for v in three][:2]
    for a, b in zip(two, three, strict=False):
        assert np.array_equal(a.view.camera.world_to_camera, b.view.camera.world_to_camera)


def test_own_cameras_are_candidates_and_are_taken_where_they_show_most(scene: Scene) -> None:
    good = Camera.look_at([-1.2, -1.3, 0.9], [-1.2, 0, 0.3], [0, 0, 1], 320, 240, 50, "DSC1.jpg")
    away = Camera.look_at([1.8, 1.8, 1.0], [1.8, 3.0, 1.0], [0, 0, 1], 320, 240, 50, "DSC2.jpg")
    photographed = scene.replace(cameras=(away,) * 8 + (good,))
    first = choose(Sights.of(photographed), [RED], 1, SIZE)[0]
    assert first.view.kind == "camera" and first.view.camera.name == "DSC1.jpg" and first.view.name == "camera 8"


def test_uniform_and_random_choices_do_not_look_at_the_question(sights: Sights) -> None:
    for choose_ in (choose_uniform, choose_random):
        red, blue = choose_(sights, [RED], 4, SIZE, seed=3), choose_(sights, [BLUE], 4, SIZE, seed=3)
        assert [v.view.name for v in red] == [v.view.name for v in blue] and len(red) == 4
    other = choose_random(sights, [RED], 4, SIZE, seed=4)
    assert [v.view.name for v in other] != [v.view.name for v in choose_random(sights, [RED], 4, SIZE, seed=3)]


@pytest.mark.slow
def test_ours_shows_more_than_uniform_and_random(sights: Sights) -> None:
    def shown(views: tuple[for_groups.ChosenView, ...], groups: list[int]) -> float:
        return float(np.mean([max(v.readable[g] for v in views) for g in groups]))

    def total(choose_: for_groups.Choose, seed: int = 0) -> float:
        return sum(shown(choose_(sights, g, n, SIZE, seed), g) for g in ([RED], [BLUE], [RED, BLUE]) for n in (1, 2))

    ours = total(choose)
    assert ours > total(choose_uniform) and ours > max(total(choose_random, s) for s in range(5))
    assert shown(choose(sights, [RED, BLUE], 3, SIZE), [RED, BLUE]) > 0.9


def test_unknown_and_deleted_groups_are_refused(scene: Scene, sights: Sights) -> None:
    with pytest.raises(UserError, match="no group 99"):
        choose(sights, [99], 1)
    assert scene.language is not None
    with pytest.raises(UserError, match="embed"):
        Sights.of(scene.replace(language=None))


def test_readability_grows_with_size_and_wholeness() -> None:
    shares = np.linspace(0, 0.2, 50)
    assert (np.diff(readability(shares, np.full(50, 0.2))) >= 0).all()
    assert readability(np.array([0.01]), np.array([0.4])) < readability(np.array([0.01]), np.array([0.015]))
    assert readability(np.array([0.0]), np.array([0.1]))[0] == 0
    assert readability(np.array([0.1]), np.array([np.inf]))[0] == pytest.approx(0.5)
