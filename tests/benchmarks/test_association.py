"""Association of masks of many views, on scenes with known objects and masks with the errors of detectors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import torch
from masked_yard import SIZE, THINGS, around, seen_by, with_tops, yard
from numpy.typing import NDArray
from painted_world import World

from scenewright.benchmarks._select.association import INSIDE, Tracks, associate
from scenewright.gaussians.cloud import GaussianCloud, concat
from scenewright.gaussians.language.masks import ViewMasks
from scenewright.gaussians.language.masks.lifting import lift


def above(added: GaussianCloud, cloud: GaussianCloud) -> GaussianCloud:
    """Some Gaussians with ids of their own beside a cloud."""
    return added.replace(ids=torch.arange(len(added)) + int(cloud.ids.max()) + 1)


@pytest.fixture
def scene() -> tuple[GaussianCloud, NDArray[np.int64]]:
    made = yard()
    return made.cloud(), made.labels(THINGS)


def ious(tracks: Tracks, truth: NDArray[np.int64], seen: NDArray[np.bool_]) -> dict[str, float]:
    """IoU of each object's track with the Gaussians of it that any view sees; 0 where it has no track."""
    found = dict.fromkeys(THINGS, 0.0)
    for k, track in enumerate(tracks.tracks):
        if track.label:
            own = (np.asarray(tracks.share[:, [k]].todense()).ravel() > INSIDE) & seen
            true = (truth == THINGS.index(track.label)) & seen
            found[track.label] = max(found[track.label], float((own & true).sum() / (own | true).sum()))
    return found


def judged(
    cloud: GaussianCloud, truth: NDArray[np.int64], views: Sequence[ViewMasks]
) -> tuple[Tracks, dict[str, float]]:
    lifted = lift(cloud, views)
    tracks = associate(lifted)
    return tracks, ious(tracks, truth, np.asarray((lifted.seen > 0.5).sum(axis=1)).ravel() > 0)


def test_every_object_is_one_track_with_its_label(scene: Any) -> None:
    cloud, truth = scene
    tracks, found = judged(cloud, truth, seen_by(cloud, truth, around(20)))
    assert sorted(t.label for t in tracks.tracks) == sorted(THINGS) and tracks.discarded == 0
    assert all(t.parent == -1 and t.views <= t.visible_in for t in tracks.tracks)
    assert min(found.values()) > 0.9  # whole pixels at the rims are given to what makes up most of them


@pytest.mark.parametrize(("dropped", "least"), [(0.2, 0.9), (0.5, 0.85), (0.8, 0.75)])
def test_views_may_be_missing(scene: Any, dropped: float, least: float) -> None:
    cloud, truth = scene
    views = seen_by(cloud, truth, around(20))
    kept = np.sort(np.random.default_rng(1).permutation(20)[: round(20 * (1 - dropped))])
    tracks, found = judged(cloud, truth, [views[i] for i in kept])
    assert sorted({t.label for t in tracks.tracks}) == sorted(THINGS)
    assert min(found.values()) > least  # of what the views left see; fewer views cut rims less finely


def test_one_view_makes_what_it_shows(scene: Any) -> None:
    cloud, truth = scene
    tracks, found = judged(cloud, truth, seen_by(cloud, truth, around(7)[:1]))
    assert {t.label for t in tracks.tracks} == set(THINGS) and all(t.views == t.visible_in == 1 for t in tracks.tracks)
    assert min(found.values()) > 0.6  # Gaussians behind a rim pixel cannot be told from those on it


def test_a_fifth_of_the_names_may_be_wrong(scene: Any) -> None:
    cloud, truth = scene
    rng, views = np.random.default_rng(2), seen_by(cloud, truth, around(20))
    wrong = [replace(v, labels=tuple("cat" if rng.random() < 0.2 else label for label in v.labels)) for v in views]
    assert sum(label == "cat" for v in wrong for label in v.labels) >= 10
    tracks, found = judged(cloud, truth, wrong)
    assert "cat" not in {t.label for t in tracks.tracks} and min(found.values()) > 0.9
    assert any(dict(t.votes).get("cat") for t in tracks.tracks)  # counted, but not the label


def test_masks_confirmed_by_too_few_views_are_discarded(scene: Any) -> None:
    cloud, truth = scene
    views = seen_by(cloud, truth, around(20))
    ghost = np.where(np.arange(SIZE[0])[None, :] < 60, 0, -1) * np.ones((SIZE[1], 1), int)
    odd = ViewMasks(views[3].camera, ghost.astype(np.int32), ("person",), np.array([0.9], np.float32))
    tracks, found = judged(cloud, truth, [*views, odd])
    assert "person" not in {t.label for t in tracks.tracks} and tracks.discarded >= 1 and min(found.values()) > 0.9


def test_a_label_that_few_views_give_is_not_used(scene: Any) -> None:
    cloud, truth = scene
    views = [
        replace(v, labels=tuple("" if label == "crate" and i % 5 else label for label in v.labels))
        for i, v in enumerate(seen_by(cloud, truth, around(20)))
    ]
    tracks, _ = judged(cloud, truth, views)
    (crate,) = (t for t in tracks.tracks if dict(t.votes).get("crate"))
    assert crate.label == "" and crate.views > 15 and {t.label for t in tracks.tracks} >= {"chair", "table", "cup"}


def test_an_occluder_that_no_mask_names_keeps_its_own(scene: Any) -> None:
    cloud, truth = scene
    screen = World().sheet("screen", (0.2, -1.0, 0), (0.9, 0, 0), (0, 0, 1.2), (0.9, 0.9, 0.9), 0.04).cloud()
    both, ids = concat([cloud, above(screen, cloud)]), np.concatenate([truth, np.full(len(screen), -1)])
    tracks, found = judged(both, ids, seen_by(both, ids, around(20)))
    assert min(found.values()) > 0.9
    taken = np.asarray((tracks.share[len(cloud) :] > INSIDE).sum(axis=1)).ravel() > 0
    assert taken.mean() < 0.03  # its rim


def test_floaters_before_the_lens_join_nothing(scene: Any) -> None:
    cloud, truth = scene
    g = torch.Generator().manual_seed(4)
    strays = cloud[torch.randperm(len(cloud), generator=g)[:60]]
    strays = strays.replace(means=torch.rand(60, 3, generator=g) * 3 - 1.5 + torch.tensor([0, 0, 2.0]))
    both, ids = concat([cloud, above(strays, cloud)]), np.concatenate([truth, np.full(60, -1)])
    tracks, found = judged(both, ids, seen_by(cloud, truth, around(20)))  # the masks know nothing of them
    assert min(found.values()) > 0.9
    assert (np.asarray((tracks.share[len(cloud) :] > INSIDE).sum(axis=1)).ravel() > 0).mean() < 0.1


def test_no_masks_make_no_tracks(scene: Any) -> None:
    cloud, _ = scene
    nothing = [ViewMasks(c, np.full(SIZE[::-1], -1, np.int32), (), np.zeros(0, np.float32)) for c in around(3)]
    for views in (nothing, []):
        tracks = associate(lift(cloud, views))
        assert not tracks.tracks and tracks.share.shape == (len(cloud), 0)


def test_masks_of_parts_without_a_name_lie_in_their_thing(scene: Any) -> None:
    cloud, truth = scene
    tracks, found = judged(cloud, truth, with_tops(cloud, truth, seen_by(cloud, truth, around(20))))
    (part,) = (t for t in tracks.tracks if not t.label)
    assert tracks.tracks[part.parent].label == "table" and min(found.values()) > 0.9


def test_the_same_masks_give_the_same_bytes_and_their_order_does_not_matter(scene: Any) -> None:
    cloud, truth = scene
    views = seen_by(cloud, truth, around(9))
    first, again, turned = (associate(lift(cloud, v)) for v in (views, views, views[::-1]))
    assert first.tracks == again.tracks and first.share.data.tobytes() == again.share.data.tobytes()
    assert [(t.label, t.views) for t in first.tracks] == [(t.label, t.views) for t in turned.tracks]
    assert abs(first.share - turned.share).max() < 1e-5  # sums over views in another order


def test_vectors_tell_things_apart_where_names_are_missing(scene: Any) -> None:
    cloud, truth = scene
    rng = np.random.default_rng(5)
    of = dict(zip(THINGS, np.eye(4, 16), strict=True))
    views = []
    for v in seen_by(cloud, truth, around(12)):
        rows = np.array([of[label] + rng.normal(0, 0.1, 16) for label in v.labels])
        views.append(replace(v, labels=("",) * len(v), vectors=rows))
    tracks = associate(lift(cloud, views))
    assert len(tracks.tracks) == 4
    best = [int(np.argmax(t.vector[:4])) for t in tracks.tracks if t.vector is not None]
    assert sorted(best) == [0, 1, 2, 3]
    for track in tracks.tracks:  # a mean over a dozen views is nearer the truth than any of them
        assert track.vector is not None and track.vector.max() > 0.98 and abs(np.linalg.norm(track.vector) - 1) < 1e-5
