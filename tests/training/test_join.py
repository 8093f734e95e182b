"""One encoder from the towers of several: its graphs compute what the parts compute, and its vectors are fitted."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import torch

from scenewright.gaussians.language.encoders.backends.embedded import Embedded
from scenewright.gaussians.language.encoders.calibration import Calibration
from scenewright.training import captions, export, fit, join, renders
from scenewright.training.model import DIM, IMAGE_SIZE
from scenewright.training.room_groups import RoomGroups

pytest.importorskip("onnx")
RNG = np.random.default_rng(0)
WORDS = captions.vocabulary(("bowl", "chair", "table"))
JOB = fit.task(WORDS, captions.words(WORDS))


@pytest.fixture(scope="module")
def parts(tmp_path_factory: pytest.TempPathFactory) -> list[Embedded]:
    """Two encoders of random weights."""
    folders = [tmp_path_factory.mktemp(f"part{i}") for i in range(2)]
    for seed, folder in enumerate(folders):
        torch.manual_seed(seed)
        model = fit.DualEncoder(len(JOB.index), len(JOB.classes)).eval()
        export.write_weights(folder, fit.Towers(model.image, model.text, 12.0, 0), JOB)
        export.write_calibration(folder, Calibration(12.0, 0.5))
    return [Embedded(folder) for folder in folders]


def _anchors() -> join.Anchors:
    """Orthonormal vectors."""
    vectors = np.linalg.qr(RNG.normal(size=(2 * DIM, len(JOB.classes))))[0].T
    return join.Anchors(np.ascontiguousarray(vectors, dtype=np.float32), 20.0)


def test_vectors_of_pictures_stand_side_by_side(parts: list[Embedded], tmp_path: Path) -> None:
    join.write(tmp_path, parts, _anchors())
    joined = Embedded(tmp_path)
    assert (joined.dim, joined.image_size, joined.calibration.scale) == (2 * DIM, IMAGE_SIZE, 20.0)
    assert joined.vocabulary == parts[-1].vocabulary
    pictures = RNG.integers(0, 255, size=(5, IMAGE_SIZE, IMAGE_SIZE, 3), dtype=np.uint8)
    expected = np.concatenate([part.encode_images(pictures) for part in parts], axis=1) / np.sqrt(2)
    assert np.allclose(joined.encode_images(pictures), expected, atol=1e-5)  # the same float16 weights and operations


def test_phrases_go_to_the_vectors_of_the_labels_they_are_near_to(parts: list[Embedded], tmp_path: Path) -> None:
    anchors, texts = _anchors(), ["the red chair", "wooden table", "seat"]
    join.write(tmp_path, parts, anchors)
    cosines = join.SHARP * parts[-1].encode_text(texts) @ parts[-1].encode_text(list(JOB.classes)).T
    shares = np.exp(cosines - cosines.max(axis=1, keepdims=True))
    mean = shares @ anchors.vectors
    expected = mean / np.linalg.norm(mean, axis=1, keepdims=True)
    assert np.allclose(Embedded(tmp_path).encode_text(texts), expected, atol=1e-2)  # weights are stored as float16


def test_features_are_a_function_of_the_seed(parts: list[Embedded]) -> None:
    pixels = RNG.integers(0, 255, size=(3, renders.VIEWS, renders.CROP, renders.CROP, 4), dtype=np.uint8)
    pixels[..., :3] = np.minimum(pixels[..., :3], pixels[..., 3:])
    names = np.array(["chair", "table", "bowl"])
    crops = renders.Crops(pixels, names, np.array(["whole"] * 3), np.arange(3), np.ones((3, 3), np.float32))
    first, second, other = (join.features(parts, crops, seed) for seed in (5, 5, 6))
    assert first.shape == (3, renders.VIEWS, 2 * DIM) and np.array_equal(first, second)
    same = np.isclose(first, other, atol=1e-6).all(axis=(0, 2))
    assert same.tolist() == [True] * (renders.VIEWS - join.AUGMENTED) + [False] * join.AUGMENTED


def test_vectors_of_labels_are_fitted_and_a_function_of_the_seed() -> None:
    names = [name for name in JOB.classes for _ in range(12)]
    middle = RNG.normal(size=(len(JOB.classes), 32))
    seen = np.repeat(middle, 12, axis=0)[:, None] + 0.3 * RNG.normal(size=(len(names), renders.VIEWS, 32))
    first, second = (join.fit_anchors(seen.astype(np.float32), names, JOB, 3, steps=40) for _ in range(2))
    assert np.array_equal(first.vectors, second.vectors) and first.scale == second.scale
    assert np.allclose(np.linalg.norm(first.vectors, axis=1), 1, atol=1e-5)
    guess = (seen.mean(axis=1) @ first.vectors.T).argmax(axis=1)
    assert np.mean(np.array(JOB.classes)[guess] == np.array(names)) > 0.95


def test_groups_of_rooms_move_the_vectors_of_their_labels_towards_them() -> None:
    """In rooms the things of one label look otherwise: without them, they would be taken for the label beside it."""
    names = [name for name in JOB.classes for _ in range(12)]
    middle = RNG.normal(size=(len(JOB.classes), 32))
    seen = np.repeat(middle, 12, axis=0)[:, None] + 0.3 * RNG.normal(size=(len(names), renders.VIEWS, 32))
    there = 0.45 * middle[0] + 0.55 * middle[1] + 0.1 * RNG.normal(size=(30, 32))
    rooms = RoomGroups(there.astype(np.float32), (JOB.classes[0],) * 30)
    alone, with_rooms = (
        join.fit_anchors(seen.astype(np.float32), names, JOB, 3, steps=120, rooms=r).vectors for r in (None, rooms)
    )
    assert (
        np.mean((there @ alone.T).argmax(axis=1) == 0) < 0.5 < 0.9 < np.mean((there @ with_rooms.T).argmax(axis=1) == 0)
    )
    guess = (seen.mean(axis=1) @ with_rooms.T).argmax(axis=1)
    assert np.mean(np.array(JOB.classes)[guess] == np.array(names)) > 0.95
