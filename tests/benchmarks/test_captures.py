"""Laws of the measures on captures: outlines, silhouettes, the best union of groups, and the phrases beside them."""

from __future__ import annotations

import json
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
import torch

from scenewright.benchmarks._iou import iou
from scenewright.benchmarks._select import composed
from scenewright.benchmarks._select.cases import Case
from scenewright.benchmarks._select.real import captures, drawings, settings
from scenewright.benchmarks._select.real.drawings import Drawing, Weights, agreement, silhouettes
from scenewright.gaussians import assets
from scenewright.gaussians.camera import Camera

SAID = json.loads((settings.HERE / "said.json").read_text(encoding="utf-8"))
DRAWN = sorted((settings.HERE / "drawn").glob("*.json"))


def test_every_capture_has_its_phrases_and_every_meaning_is_drawn() -> None:
    assert set(SAID) == set(settings.SETTINGS)
    for name, entry in SAID.items():
        outlines = settings.HERE / "drawn" / f"{name}.json"
        known = set(entry.get("labels", ()))
        if not known:
            known = {t for photo in json.loads(outlines.read_text()).values() for t, _ in photo["regions"]}
        meant = [n for thing in entry["things"].values() for reading in thing["means"] for n in reading]
        assert set(meant) <= known, name
        assert {n for names in entry["ambiguous"].values() for n in names} <= known, name


def test_no_phrase_is_said_twice_and_half_are_held_out() -> None:
    for name, entry in SAID.items():
        said = [p for t in entry["things"].values() for p in (*t["said"], *t["held_out"])]
        others = [*entry["undrawn"], *entry["absent"], *entry["ambiguous"]]
        assert len({*said, *others}) == len(said) + len(others), name
        assert all(t["said"] and t["held_out"] for t in entry["things"].values()), name


@pytest.mark.parametrize("path", DRAWN, ids=lambda p: p.stem)
def test_outlines_lie_within_their_photographs(path: Path) -> None:
    for photo in json.loads(path.read_text(encoding="utf-8")).values():
        width, height = photo["size"]
        for _, points in photo["regions"]:
            assert len(points) >= 6 and len(points) % 2 == 0
            assert all(0 <= x <= width for x in points[::2]) and all(0 <= y <= height for y in points[1::2])


def test_ignored_pixels_do_not_count() -> None:
    camera = Camera.look_at((0, -1, 0), (0, 0, 0), (0, 0, 1), 40, 20)
    labels = np.zeros((20, 40), np.uint8)
    labels[:, :20], labels[:, 30:] = 3, drawings.UNLABELED
    drawing, found = Drawing(camera, labels), np.ones((20, 40), bool)
    assert agreement(found, drawing, (3,)) == pytest.approx(20 / 30)
    assert agreement(found, drawing, (4,)) is None  # not shown in this photo


@pytest.fixture(scope="module")
def chair() -> tuple[assets.Room, Camera]:
    room = assets.furnish(7001, detail=0.1)
    return room, room.scene.cameras[0].resized(120, 80)


def test_three_silhouettes_of_one_render_are_those_of_three_renders(chair: tuple[assets.Room, Camera]) -> None:
    room, camera = chair
    ids = room.truth.ids.numpy()
    chosen = np.stack([ids == k for k in range(4)])
    together = silhouettes(room.scene, chosen, camera)
    for mask, own in zip(chosen, together, strict=True):
        np.testing.assert_array_equal(own, drawings.silhouette(room.scene, mask, camera))


def test_the_best_union_is_found_as_by_trying_all() -> None:
    rng = np.random.default_rng(5)
    for _ in range(20):
        inside, outside = rng.uniform(0, 30, (2, 7)), rng.uniform(0, 60, (2, 7))
        true = np.array([200.0, 150.0])

        def reached(groups: tuple[int, ...]) -> float:
            g = list(groups)
            return float((inside[:, g].sum(axis=1) / (true + outside[:, g].sum(axis=1))).mean())  # noqa: B023

        best = max(reached(some) for n in range(8) for some in combinations(range(7), n))
        found = reached(tuple(drawings._choose(inside, outside, true).tolist()))
        assert found >= best - 0.01  # the local search moves one group at a time and may stop a little below


def test_true_groups_reach_the_silhouettes_they_were_drawn_from(chair: tuple[assets.Room, Camera]) -> None:
    room, camera = chair
    ids = room.truth.ids.numpy()
    counts = np.bincount(ids[ids >= 0])
    big = np.argsort(-counts)[:4].tolist()
    labels = np.zeros((80, 120), np.uint8)
    for k, shown in zip(big, silhouettes(room.scene, np.stack([ids == k for k in big]), camera), strict=True):
        labels[shown] = k + 1
    drawing = Drawing(camera, labels)
    weights = Weights.of(room.scene, [drawing])
    for k in big:
        if drawing.shows((k + 1,)):
            np.testing.assert_array_equal(weights.best_union(ids, [drawing], (k + 1,)), ids == k)
            np.testing.assert_array_equal(weights.best_group(ids, [drawing], (k + 1,)), ids == k)


def test_the_best_union_of_rows_is_found_as_by_trying_all() -> None:
    rng = np.random.default_rng(3)
    room = assets.furnish(7001, detail=0.05)
    scene, truth = room.scene, room.truth.ids.numpy() == 0
    groups = torch.from_numpy(rng.integers(-1, 6, len(scene.cloud)).astype(np.int32))
    groups[torch.from_numpy(truth)] = torch.from_numpy(rng.integers(0, 3, int(truth.sum())).astype(np.int32))
    case = Case(0, scene.replace(cloud=scene.cloud.replace(group=groups)), room.truth.ids.numpy(), room.truth.objects)
    column = groups.numpy()
    every = [iou(np.isin(column, some), truth) for n in range(7) for some in combinations(range(6), n)]
    assert case.best_union(truth) == pytest.approx(max(every))


@pytest.mark.slow
def test_a_composed_room_loses_its_table_and_nothing_else() -> None:
    true, blind = composed.composed_room("closet", 7200)
    assert blind.scene.language is None and bool((blind.scene.cloud.group == -1).all())
    assert torch.equal(true.scene.cloud.means, blind.scene.cloud.means)
    assert true.scene.language is not None and true.objects == blind.objects
    for thing, mask in ((o, blind.truth(o)) for o in blind.objects):
        assert mask.any()
        center = blind.points[mask].mean(axis=0)
        assert np.abs(center - thing.position).max() <= max(thing.size)


def test_a_phrase_counts_as_wrong_only_when_something_else_is_found() -> None:
    camera = Camera.look_at((0, -1, 0), (0, 0, 0), (0, 0, 1), 40, 20)
    labels = np.zeros((20, 40), np.uint8)
    labels[:, :20] = 1
    entry = {"things": {"box": {"means": [["box"]]}}, "ambiguous": {"the thing": ["box"]}}
    truth = settings.Truth(Path(), (Drawing(camera, labels),), (), {"box": 1}, entry)
    right, left = np.zeros((20, 40), bool), labels == 1
    right[:, 20:] = True
    none = np.zeros(0, bool)

    def compared(kind: str, thing: str, shown: np.ndarray, phrase: str = "the box") -> captures.Heard:
        return captures._compared(truth, captures.Heard(phrase, kind, thing, "found", none), [shown])

    assert compared("said", "box", left).score == 1 and not compared("said", "box", left).wrong
    assert compared("said", "box", right).wrong and compared("absent", "", right).wrong
    assert compared("undrawn", "", left).wrong and not compared("undrawn", "", right).wrong
    assert not compared("ambiguous", "", left, "the thing").wrong
