"""The moving rooms: what moves is where their tracks say, and films know it."""

import json

import numpy as np
import pytest
import torch

from scenewright.agent.session.session import Session
from scenewright.benchmarks._motion import films, fitted, identity, rooms, soft
from scenewright.gaussians.errors import InstructionError, UserError
from scenewright.gaussians.motion.at import at


@pytest.fixture(scope="module")
def ball():
    return rooms.moving_room("ball", 0.15)


def test_a_ball_rolls_across_the_rug_to_the_wall(ball):
    path = films.middles(ball, [0.0, 0.4, 1.2, 2.2, 3.5, 5.0])[0]
    rug = next(g.box for g in ball.language.groups if g.label == "rug")
    assert np.allclose(path[0], path[1]) and np.allclose(path[4], path[5])
    assert abs(path[5][0] + 0.11 - 2.5) < 0.01  # at the east wall, metres
    low, high = rug.center[0] - rug.size[0] / 2, rug.center[0] + rug.size[0] / 2
    assert path[0][0] < low < path[2][0] < path[3][0] < high < path[4][0]


def test_every_moving_row_is_of_the_thing_that_moves(ball):
    number = next(g.id for g in ball.language.groups if g.label == "ball")
    held = torch.isin(ball.cloud.ids, torch.from_numpy(ball.motion.tracks[0].ids))
    assert torch.equal(held, ball.cloud.group == number)


def test_the_mask_of_a_frame_covers_the_moved_thing(ball):
    camera = films.standing(films.STAGES["ball"], 4, (64, 48))[1]
    frame = films.Clouds(ball).frame(camera, 2.0)
    pixel, depth = camera.project(at(ball, 2.0).cloud.means[ball.cloud.group == 9].double().mean(0).numpy()[None])
    assert depth[0] > 0 and frame.mask[int(pixel[0, 1]), int(pixel[0, 0])] and frame.mask.mean() < 0.1


def test_a_film_is_written_as_a_capture_with_times(ball, tmp_path):
    made = films.film("ball", "4", (48, 36), fps=0.4, detail=0.15)
    films.write(made, tmp_path)
    frames = json.loads((tmp_path / "transforms.json").read_text())["frames"]
    assert len(frames) == len(made.frames) and {f["time"] for f in frames} == set(made.times.tolist())
    assert all(
        (tmp_path / f["file_path"]).is_file() and (tmp_path / "truth" / f["file_path"]).is_file() for f in frames
    )


def test_an_unknown_room_is_refused_with_the_known_ones():
    with pytest.raises(UserError, match="ball, door, drawer, fan, books, toy"):
        rooms.moving_room("garden")


def test_the_truth_is_judged_right_and_a_still_scene_wrong(ball):
    made = films.film("ball", "4", (64, 48), fps=0.4, detail=0.15)
    group = torch.where(made.scene.cloud.group == 9, 0, -1).to(torch.int32)
    truth = made.scene.replace(cloud=made.scene.cloud.replace(group=group))
    right, still = (fitted.judged(scene, made, 0.0) for scene in (truth, truth.replace(motion=None)))
    assert right.path < 1e-5 and right.found == 1 and right.overlap == 1 and right.whole > 60
    assert still.found == 0 and still.whole < right.whole


def test_a_film_of_a_furnished_room_shows_two_things_that_move():
    scene, stage = films.carried(11, 0.1)
    assert [track.kind for track in scene.motion.tracks] == ["rigid", "hinge"]
    path = films.middles(scene, [0.0, 4.0])[0]
    assert np.linalg.norm(path[1] - path[0]) > 0.5  # metres
    frame = films.Clouds(scene).frame(films.standing(stage, 12, (48, 36))[6], 1.0)
    assert frame.mask.any() and frame.photo.any()


@pytest.mark.slow
def test_gaussians_belong_to_what_they_show_and_no_longer_when_they_stay_behind():
    made = films.film("ball", "4", (64, 48), fps=1.0, detail=0.15)
    things = np.full(len(made.scene.cloud), -1, np.int32)
    things[np.isin(made.scene.cloud.ids.numpy(), made.scene.motion.tracks[0].ids)] = 0
    cloud = made.scene.cloud.replace(group=torch.from_numpy(things))
    true = identity.belonging(made.scene.replace(cloud=cloud), made)
    assert (
        true.assigned > 0.9 and true.kept > 0.9
    )  # of a ball of 5 pixels, not 1: Gaussians at its edge show the rug too
    unlabelled = made.scene.replace(cloud=cloud.replace(group=torch.full_like(cloud.group, -1)))
    nothing = identity.belonging(unlabelled, made)
    assert nothing.assigned == 0 and nothing.kept == true.kept
    still = identity.belonging(made.scene.replace(cloud=cloud, motion=None), made)
    assert still.kept < 0.1  # what showed the ball at first shows it no longer
    some = np.where(np.arange(len(things)) % 2, things, -1).astype(np.int32)
    half = identity.belonging(made.scene.replace(cloud=cloud.replace(group=torch.from_numpy(some))), made)
    assert 0.3 < half.assigned < 0.7


@pytest.mark.slow
def test_what_moves_is_counted_by_when_it_begins() -> None:
    session = Session(rooms.moving_room("books", 0.1))
    books = [g.id for g in session.scene.language.groups if "book" in g.label.split()]  # from left to right
    for words, place in (("first", 0), ("second", 1), ("last", 2)):
        session.do(f"hide the {words} book that falls")
        cloud = at(session.scene, 0.0).cloud
        seen = [float(cloud.opacities[cloud.group == book].max()) > 0.01 for book in books]
        assert seen == [i != place for i in range(3)]
        session.undo()
    session.do("drop all the books at the same time")
    with pytest.raises(InstructionError, match="same time"):
        session.do("hide the book that falls first")


def test_a_name_of_a_family_means_the_kind_that_fits() -> None:
    """The lamp on the desk, half a metre high, is called "lamp"."""
    session = Session(rooms.moving_room("books", 0.1))
    assert session.scene.language is not None
    lamp = next(g.id for g in session.scene.language.groups if g.label == "lamp")
    assert session.select("the desk lamp").groups == session.select("the lamp").groups == (lamp,)
    assert session.select("the floor lamp").verdict == "absent"


@pytest.mark.parametrize("name", soft.names())
def test_soft_rooms_change_a_shape_and_stand_at_the_start(name):
    scene = soft.soft_room(name, 0.15)
    (residual,) = scene.motion.residuals
    assert residual.basis.shape[1] <= 2 and np.isin(residual.ids, scene.cloud.ids.numpy()).all()
    assert (residual.basis[0] == 0).all()
    assert max(np.abs(residual.displacements(t)).max() for t in np.linspace(0, 5, 51)) > 0.1  # metres
    (thing,) = films.moving_things(scene.motion)
    assert set(thing) == set(residual.ids)
    first, later = (
        films.Clouds(scene).frame(films.standing(films.STAGES[name], 4, (64, 48))[1], t) for t in (0.0, 1.3)
    )
    assert first.mask.any() and (first.photo != later.photo).any()


def test_an_unknown_soft_room_is_refused():
    with pytest.raises(UserError, match="towel, plant, jelly"):
        soft.soft_room("garden")
