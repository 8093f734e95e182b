"""What changes its shape: nodes and their displacements, how pictures tell them, and the whole on a small film."""

from dataclasses import replace

import numpy as np
import pytest
import torch

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.fit.densify import MCMCStrategy
from scenewright.gaussians.fit.parameters import Parameters
from scenewright.gaussians.fit.train import Shot
from scenewright.gaussians.harmonics import SH_C0
from scenewright.gaussians.motion.fitting.bending import Torn, bent, bent_alone, gain_by_bending
from scenewright.gaussians.motion.fitting.bends import Bend
from scenewright.gaussians.motion.fitting.bodies import Body, Columns, Labelled, turned
from scenewright.gaussians.motion.fitting.budget import Budget
from scenewright.gaussians.motion.fitting.finding import Finder
from scenewright.gaussians.motion.fitting.footage import Footage, rounded
from scenewright.gaussians.motion.fitting.sketch import at_all_times
from scenewright.gaussians.motion.fitting.tracking import Tracker
from scenewright.gaussians.motion.fitting.training import Joint
from scenewright.gaussians.render.cpu import gradient

TIMES = np.linspace(0, 1, 11)


def points(count: int = 60) -> np.ndarray:
    return np.random.default_rng(0).uniform(-1, 1, (count, 3)).astype(np.float32)


def some_bend(times: int = 4) -> Bend:
    bend = Bend.none(points(), times)
    moves = np.random.default_rng(1).normal(size=bend.moves.shape)
    moves[0] = 0
    return replace(bend, moves=moves)


def test_nodes_are_spread_and_shares_are_whole():
    means = points(200)
    bend = Bend.none(means, 3)
    apart = np.linalg.norm(bend.nodes[:, None] - bend.nodes, axis=2) + 9 * np.eye(len(bend.nodes))
    assert (
        len(bend.nodes) == 24 and apart.min() > 0.4 and bend.reach == pytest.approx(0.6 * np.median(apart.min(axis=1)))
    )
    shares = bend.shares(means)
    assert np.abs(shares.sum(axis=1) - 1).max() < 1e-6 and (bend.displaced(1, means) == means).all()
    assert (bend.shares(means * 50).sum(axis=1) > 0.99).all()  # far away, the nearest node is felt
    assert len(Bend.none(means[:9], 3).nodes) == 1 and Bend.none(means[:9], 3).near.tolist() == [[0]]


def test_all_nodes_moved_alike_shift_the_body():
    bend, means = some_bend(), points()
    shift = np.array([0.1, -0.2, 0.3])
    bend = bend.with_moves(slice(2, 3), np.tile(shift, (len(bend.nodes), 1)))
    assert np.allclose(bend.displaced(2, means), means + shift, atol=1e-6)
    assert np.allclose(bend.together(bend.moves[2], 0.5), bend.moves[2])
    assert np.ptp(bend.together(bend.moves[1], 1.0), axis=0).max() < np.ptp(bend.moves[1], axis=0).max()


def test_a_body_that_bends_is_where_it_was_when_it_is_put_there():
    means, quats, rng = points(), np.tile(np.float32([1, 0, 0, 0]), (60, 1)), np.random.default_rng(3)
    body = Body(rng.normal(size=3), np.tile([1.0, 0, 0, 0], (4, 1)), rng.normal(size=(4, 3)), bend=some_bend())
    body.quats[:] = [turned(q, rng.normal(size=3)) for q in body.quats]
    there, turned_there = body.placed(0, means, quats)
    other = body.started_at(0)
    for t in range(4):
        assert np.allclose(other.placed(t, there, turned_there)[0], body.placed(t, means, quats)[0], atol=1e-5)
        elsewhere = body.seen_from(np.ones(3)).placed(t, means, quats)[0]
        assert np.allclose(elsewhere, body.placed(t, means, quats)[0], atol=1e-5)
        back = body.backwards().placed(3 - t, means, quats)[0]
        assert np.allclose(back, body.placed(t, means, quats)[0])
    assert Body.at_rest(np.zeros(3), 4).runs == [(0, 4)]
    assert replace(Body.at_rest(np.zeros(3), 4), bend=some_bend()).runs == [(0, 1), (1, 2), (2, 3), (3, 4)]


def test_shapes_between_two_times_go_evenly_from_one_to_the_other():
    body = replace(Body.at_rest(np.zeros(3), 4), bend=some_bend())
    found = at_all_times(body, np.array([0.0, 1, 2, 3]), np.array([0.0, 0.5, 1, 2, 3]))
    assert np.allclose(found.bend.moves[1], body.bend.moves[1] / 2) and len(found.offsets) == 5
    assert np.allclose(found.bend.moves[3], body.bend.moves[2])


def test_displacements_are_told_with_as_low_a_rank_as_they_have():
    bend, rng = some_bend(20), np.random.default_rng(4)
    basis, ways = rng.normal(size=(20, 2)), rng.normal(size=(2, len(bend.nodes), 3))
    basis[0] = 0
    bend = replace(bend, moves=np.einsum("tb,bkc->tkc", basis, ways) + 1e-4 * rng.normal(size=bend.moves.shape))
    means = points()
    told, weights = bend.low_rank(means, 0.001)
    assert told.shape == (20, 2) and weights.shape == (60, 2, 3)
    for t in (0, 7, 19):
        assert np.allclose(means + np.einsum("b,nbc->nc", told[t], weights), bend.displaced(t, means), atol=2e-3)
    assert bend.low_rank(means, 100.0)[0].shape == (20, 0)


@pytest.fixture(scope="module")
def waving() -> tuple[Columns, np.ndarray, np.ndarray, Footage]:
    """A patterned sheet before a wall that bends towards the cameras and back, its rows, where they are at each time
    `[T, n, 3]`, and its frames."""
    rng = np.random.default_rng(5)
    x, z = (a.reshape(-1) for a in np.meshgrid(np.linspace(-0.4, 0.4, 11), np.linspace(0, 1.2, 16)))
    sheet = np.stack([x, np.zeros_like(x), z], axis=1)
    u, v = (a.reshape(-1) for a in np.meshgrid(np.linspace(-1.6, 1.6, 21), np.linspace(-0.3, 1.8, 15)))
    wall = np.stack([u, np.full_like(u, 1.0), v], axis=1)
    colors = np.concatenate([rng.uniform(0, 1, (12, 3))[(x > 0) + 2 * (z / 0.2).astype(int) % 12], 0.5 + 0 * wall])
    means, count = np.concatenate([sheet, wall]).astype(np.float32), len(sheet) + len(wall)
    columns = (
        means, np.tile(np.float32([1, 0, 0, 0]), (count, 1)),
        np.repeat(np.r_[np.full(len(sheet), 0.04), np.full(len(wall), 0.08)], 3).reshape(-1, 3).astype(np.float32),
        np.full(count, 0.9, np.float32), ((colors - 0.5) / SH_C0).astype(np.float32)[:, None],
    )  # fmt: skip
    swing = 0.2 * (1 - np.cos(2 * np.pi * np.clip(1.25 * TIMES - 0.25, 0, 1)))  # scene units
    there = sheet + swing[:, None, None] * (z**2)[:, None] * np.array([0.6, -1.0, -0.2])
    shots = []
    for eye in ((-1.5, -2.0, 1.2), (0.0, -2.4, 0.6), (1.5, -2.0, 1.0), (0.6, -2.0, 1.9)):
        view = Camera.look_at(eye, (0, 0, 0.6), (0, 0, 1), 80, 60, name=f"at {eye[0]}")
        for t, own in zip(TIMES, there, strict=True):
            now = (np.concatenate([own, wall]).astype(np.float32), *columns[1:])
            shots.append(Shot(view, rounded(gradient.draw(now, view, (0.0, 0.0, 0.0)).rgb), float(t)))
    return columns, np.arange(len(sheet)), there, Footage.of(shots, [s.time for s in shots])


def away(body: Body, columns: Columns, rows: np.ndarray, there: np.ndarray) -> float:
    """Mean distance of Gaussians from where they are, over all times, scene units."""
    placed = [body.placed(t, columns[0][rows], columns[1][rows])[0] for t in range(len(there))]
    return float(np.linalg.norm(np.stack(placed) - there, axis=2).mean())


def tracker_of(columns: Columns, rows: np.ndarray, footage: Footage) -> Tracker:
    return Tracker(columns, rows, ~np.isin(np.arange(len(columns[0])), rows), footage, 0)


def test_pictures_tell_how_a_sheet_bends(waving):
    columns, rows, there, footage = waving
    tracker = tracker_of(columns, rows, footage)
    still = Body.at_rest(tracker.pivot, len(TIMES))
    found = bent_alone(tracker, range(2, 10))
    assert found is not None and (found.bend.moves[1:3] == 0).all()  # it rests until then
    assert away(found, columns, rows, there) < 0.25 * away(still, columns, rows, there)
    path = Body(still.pivot, still.quats.copy(), still.offsets.copy())
    path.offsets[3:] = (there[3:] - there[0]).mean(axis=1)
    torn = Torn(((np.arange(len(rows)), path),))
    assert gain_by_bending(tracker, torn, path, None, (5, 7)) < 0.6
    starts = torn.moves(found.bend, tracker.means)
    assert gain_by_bending(tracker, torn, still, starts, (5, 7)) < 0.6
    assert away(bent(tracker, path), columns, rows, there) < 0.3 * away(still, columns, rows, there)
    assert away(bent(tracker, still, starts), columns, rows, there) < 0.5 * away(still, columns, rows, there)


def test_what_only_turns_does_not_bend(swinging):
    columns, labels, body, footage = swinging
    tracker = tracker_of(columns, np.flatnonzero(labels), footage)
    torn = Torn(((np.arange(len(tracker.means)), body),))
    assert gain_by_bending(tracker, torn, body.seen_from(tracker.pivot), None, (2, 4)) > 0.9


def test_what_hides_is_not_explained(waving, monkeypatch):
    columns, rows, _, footage = waving
    tracker = tracker_of(columns, rows, footage)
    monkeypatch.setattr(Tracker, "area", lambda self, body, t: 100 if t == 0 else 10)
    assert bent_alone(tracker, (5, 7)) is None


def test_a_sheet_that_bends_is_found(waving):
    columns, rows, there, footage = waving
    finder = Finder(footage, 0, np.random.default_rng(0), Budget(None), lambda: None, bends=True)
    labelled, bodies, _ = finder.find(parameters(columns))
    (body,) = bodies
    moving = np.linalg.norm(there - there[0], axis=2).max(axis=0) > 0.1
    assert body.bend is not None and (labelled.labels[rows[moving]] == 1).mean() > 0.9
    still = Body.at_rest(np.zeros(3), len(TIMES))
    assert away(body, columns, rows, there) < 0.6 * away(still, columns, rows, there)


@pytest.fixture
def loosely(waving) -> tuple[Joint, np.ndarray, Body]:
    """A training of the sheet whose displacements are known but for a quarter, and the true body."""
    columns, rows, there, footage = waving
    none = Bend.none(columns[0][rows], len(TIMES))
    near = np.linalg.norm(columns[0][rows][:, None] - none.nodes, axis=2).argmin(axis=0)
    true = replace(Body.at_rest(np.zeros(3), len(TIMES)), bend=replace(none, moves=(there - there[0])[:, near]))
    labels = np.isin(np.arange(len(columns[0])), rows).astype(np.int32)
    labelled = Labelled.labelled(parameters(columns), labels)
    rough = replace(true, bend=replace(true.bend, moves=0.75 * true.bend.moves))
    strategy = MCMCStrategy(len(labels), np.random.default_rng(0))
    return Joint(labelled, [rough], footage, strategy, np.random.default_rng(1)), rows, true


def test_displacements_are_trained_but_for_those_of_the_first_time(loosely):
    joint, _, true = loosely

    def off() -> float:
        return float(np.linalg.norm(joint.bodies[0].bend.moves - true.bend.moves, axis=2).mean())

    before = off()
    for k in range(400):
        joint.step(k / 400)
    assert (joint.bodies[0].bend.moves[0] == 0).all() and off() < 0.7 * before
    assert (joint.bodies[0].offsets == 0).all()  # it has no path beside


def test_what_bends_settles_with_its_displacements(loosely):
    """Where a body settles turned, what is trained afterwards goes on from there."""
    joint, rows, _ = loosely
    body = joint.bodies[0]
    quats = np.tile(turned(body.quats[0], np.array([0.0, 0.0, 0.4])), (len(TIMES), 1))
    joint.bodies[0] = replace(body, quats=quats)
    means, plain = joint.parameters.means[rows].copy(), np.tile(np.float32([1, 0, 0, 0]), (len(rows), 1))
    before = [joint.bodies[0].placed(t, means, plain)[0] for t in range(len(TIMES))]
    joint.settle()
    for _ in range(2):
        after = [joint.bodies[0].placed(t, joint.parameters.means[rows], plain)[0] for t in range(len(TIMES))]
        assert np.abs(np.stack(after) - np.stack(before)).max() < 0.02  # scene units
        joint.step(1.0)


def parameters(columns: Columns) -> Parameters:
    return Parameters.of(GaussianCloud.create(*(torch.from_numpy(c.copy()) for c in columns)))


@pytest.mark.slow
def test_a_plant_that_bends_is_better_with_residuals_than_with_paths():
    from scenewright.benchmarks._motion import films
    from scenewright.benchmarks._motion.fitted import fitted

    film = films.film("plant", "12", (112, 84), fps=5)
    rigid, soft = (fitted(film, 900, detail) for detail in ("rigid", "residual"))
    assert soft.inside > rigid.inside + 2 and soft.whole > rigid.whole and soft.residual > 0  # dB
    assert soft.assigned > rigid.assigned
