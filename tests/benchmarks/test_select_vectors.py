"""Groups against vectors: the rival is built fairly, and variants of an encoder change only what they say."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import torch

from scenewright.benchmarks._select import variants, vectors
from scenewright.benchmarks._select.cases import Case
from scenewright.benchmarks._select.pictures import Photos, Seen
from scenewright.gaussians.assets import TruthObject
from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.language.encoders import Encoder
from scenewright.gaussians.language.encoders.backends.vectors import wrap
from scenewright.gaussians.language.encoders.calibration import Calibration
from scenewright.gaussians.language.masks import ViewMasks
from scenewright.gaussians.scene import Frame, Scene

EYE = Camera.look_at([0, -3, 0], [0, 0, 0], [0, 0, 1], 32, 32)


def test_all_principal_axes_give_the_vectors_back_and_fewer_give_the_nearest() -> None:
    rows = np.random.default_rng(0).standard_normal((200, 12)).astype(np.float32) * np.arange(1, 13, dtype=np.float32)
    losses = []
    for width in (12, 6, 2):
        mean, axes = vectors.principal(rows, width)
        losses.append(float(np.square((rows - mean) @ axes.T @ axes + mean - rows).mean()))
    assert losses[0] < 1e-8 and losses == sorted(losses)  # float32 of values up to 12, squared
    assert losses[2] < float(np.square(rows - rows.mean(axis=0))[:, :10].mean())  # the two widest columns are kept


@pytest.fixture
def words() -> Encoder:
    """Two names at right angles."""
    return wrap([("sofa",), ("lamp",)], np.eye(2), Calibration(20.0, 0.5))


@pytest.fixture
def two() -> tuple[Case, list[Seen]]:
    """A sofa to the left and a lamp to the right, in one flawless picture."""
    x = torch.tensor([-0.6, -0.5, -0.4, 0.4, 0.5, 0.6])
    means = torch.stack([x, torch.zeros(6), torch.zeros(6)], dim=1)
    there = GaussianCloud.create(
        means, torch.tensor([1.0, 0, 0, 0]).repeat(6, 1), torch.full((6, 3), 0.05), torch.full((6,), 0.9),
        torch.zeros(6, 1, 3),
    )  # fmt: skip
    things = tuple(
        TruthObject(i, kind, "red", (1.0, 1.0, 1.0), (0.0, 0.0, 0.0), 0.0, "floor", ())
        for i, kind in enumerate(("sofa", "lamp"))
    )
    ids = np.where(np.arange(32)[None, :] < 16, 0, 1).repeat(32, axis=0).astype(np.int32)
    masks = ViewMasks(EYE, ids, ("", ""), np.ones(2, np.float32), np.eye(2, dtype=np.float32))
    case = Case(1, Scene(there, Frame(), (EYE,)), (np.arange(6) >= 3).astype(np.int32), things)
    return case, [Seen(masks, (0, 1))]


def test_with_flawless_masks_groups_and_vectors_are_both_right(two: tuple[Case, list[Seen]], words: Encoder) -> None:
    case, seen = two
    up = vectors.uplift(case, seen)
    assert up.covered.all()
    for outcome in (
        vectors.as_groups(case, up, words, ("sofa", "lamp")),
        vectors.as_true_groups(case, up, words, ("sofa", "lamp")),
        vectors.as_vectors(case, up, words, ("sofa", "lamp"), 2),
    ):
        assert outcome.iou == [1.0, 1.0] and outcome.margin > 0.9 and outcome.seconds >= outcome.query > 0
    assert vectors.as_vectors(case, up, words, ("sofa",), 1).bytes == 4 * len(case.ids)


def test_variants_change_only_what_they_say(words: Encoder) -> None:
    bold = variants.with_threshold(words, 0.1)
    assert replace(bold.calibration, threshold=0.5) == words.calibration and bold.calibration.threshold == 0.1
    assert bold.fingerprint == words.fingerprint and (bold.encode_text(["lamp"]) == words.encode_text(["lamp"])).all()
    assert variants.without_size(words).calibration.size_weight == 0
    assert variants.without_negatives(words).vocabulary.negatives == ()


def test_photos_of_one_thing_are_alike_and_of_an_unknown_kind_are_nothing() -> None:
    exemplars = np.zeros((3, 512))
    exemplars[0, 0] = exemplars[1, 1] = 1
    taken = Photos(exemplars, np.random.default_rng(0))
    picture = None  # vectors do not depend on pixels here
    first, second = (taken(picture, np.zeros((1, 1), np.int32), [0, 1, 2]) for _ in range(2))  # type: ignore[arg-type]
    assert not first[2].any()
    # cos = (1 + 0.45^2) / (1 + 2 * 0.45^2) = 0.86 in the mean; 512 numbers spread it by a few hundredths
    assert 0.8 < first[0] @ second[0] < 0.92 and abs(first[0] @ first[1]) < 0.2
