"""One suite for every encoder: what the rest of the package relies on, whoever makes the vectors."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from safetensors.numpy import load_file, save_file

from scenewright.gaussians.errors import BackendError
from scenewright.gaussians.language import encoders
from scenewright.gaussians.language.encoders import Encoder
from scenewright.gaussians.language.encoders.probability import labels, probability

_PHRASES = ["chair", "red sofa", "potted plant", "two small tables"]


@dataclass(frozen=True)
class Case:
    """One back end with real files behind it.

    Attributes:
        spec: how it is loaded.
        other: makes, in an empty folder, the specification of the same encoder with one number of its weights changed.
    """

    spec: str
    other: Callable[[Path], str]


def _embedded(request: pytest.FixtureRequest) -> Case:
    def other(folder: Path) -> str:
        shutil.copytree(encoders.weights_folder(), folder, dirs_exist_ok=True)
        _nudge(folder / "image.onnx")
        return f"embedded:{folder}"

    return Case(f"embedded:{encoders.weights_folder()}", other)  # "embedded" alone is loaded once and shared


def _open_clip(request: pytest.FixtureRequest) -> Case:
    saved: Path = request.getfixturevalue("saved_clip")

    def other(folder: Path) -> str:
        shutil.copytree(saved, folder, dirs_exist_ok=True)
        weights = load_file(saved / "open_clip_model.safetensors")
        weights["visual.proj"][0, 0] += 0.1
        save_file(weights, folder / "open_clip_model.safetensors")
        return f"open_clip:{folder}"

    return Case(f"open_clip:{saved}", other)


def _onnx(request: pytest.FixtureRequest) -> Case:
    exported: Path = request.getfixturevalue("exported_clip")

    def other(folder: Path) -> str:
        shutil.copytree(exported, folder, dirs_exist_ok=True)
        _nudge(folder / "text_model.onnx")
        return f"onnx:{folder}"

    return Case(f"onnx:{exported}", other)


def _vectors(request: pytest.FixtureRequest) -> Case:
    rows = np.random.default_rng(8).normal(size=(5, 12))
    names = ["chair", "sofa", "potted plant", "table", "cat"]

    def write(folder: Path, rows: NDArray[np.float64]) -> str:
        np.save(folder / "text.npy", rows)
        (folder / "names.json").write_text(json.dumps(names))
        return f"vectors:{folder}"

    def other(folder: Path) -> str:
        changed = rows.copy()
        changed[0, 0] += 0.1
        return write(folder, changed)

    return Case(write(request.getfixturevalue("tmp_path_factory").mktemp("vectors"), rows), other)


_CASES = {"embedded": _embedded, "open_clip": _open_clip, "onnx": _onnx, "vectors": _vectors}


@pytest.fixture(params=_CASES, scope="module")
def case(request: pytest.FixtureRequest) -> Case:
    return _CASES[request.param](request)


@pytest.fixture(scope="module")
def encoder(case: Case) -> Encoder:
    return encoders.load(case.spec)


@pytest.fixture
def seeing(encoder: Encoder) -> Encoder:
    """Those with an image tower."""
    if not encoder.image_size:
        pytest.skip("holds text vectors only; test_encoder_vectors says what it answers to pictures")
    return encoder


def test_every_back_end_is_here() -> None:
    assert set(_CASES) == set(encoders.names())


def test_rows_are_unit_vectors_of_one_width(encoder: Encoder) -> None:
    assert isinstance(encoder, Encoder)
    rows = encoder.encode_text(_PHRASES)
    assert rows.shape == (4, encoder.dim) and rows.dtype == np.float32
    np.testing.assert_allclose(np.linalg.norm(rows, axis=1), 1, atol=1e-5)  # normalised in float32
    assert len(np.unique(rows, axis=0)) == 4
    assert encoder.encode_text([]).shape == (0, encoder.dim)


def test_pictures_of_any_size_are_unit_vectors(seeing: Encoder) -> None:
    for height, width in ((seeing.image_size, seeing.image_size), (40, 30), (1, 1), (150, 150)):
        rows = seeing.encode_images(_noise(3, height, width))
        assert rows.shape == (3, seeing.dim) and rows.dtype == np.float32
        np.testing.assert_allclose(np.linalg.norm(rows, axis=1), 1, atol=1e-5)
    assert seeing.encode_images(_noise(0, 8, 8)).shape == (0, seeing.dim)


def test_a_vector_does_not_depend_on_its_company(encoder: Encoder) -> None:
    texts = encoder.encode_text(_PHRASES)
    alone = np.concatenate([encoder.encode_text([p]) for p in _PHRASES])
    np.testing.assert_allclose(texts, alone, atol=1e-5)  # sums are blocked otherwise in other batches
    np.testing.assert_array_equal(encoder.encode_text(_PHRASES[::-1])[::-1], texts)


def test_a_picture_does_not_depend_on_its_company(seeing: Encoder) -> None:
    pictures = _noise(40, 32, 32)  # more than one batch of every back end with towers of real size
    together = seeing.encode_images(pictures)
    alone = np.concatenate([seeing.encode_images(p[None]) for p in pictures[:3]])
    np.testing.assert_allclose(together[:3], alone, atol=1e-5)
    np.testing.assert_allclose(seeing.encode_images(pictures[::-1])[::-1], together, atol=1e-5)


def test_loaded_again_it_gives_the_same_bytes(case: Case, encoder: Encoder) -> None:
    again = encoders.load(case.spec)
    assert again.fingerprint == encoder.fingerprint
    assert again.encode_text(_PHRASES).tobytes() == encoder.encode_text(_PHRASES).tobytes()
    if encoder.image_size:
        pictures = _noise(5, 32, 32)
        assert again.encode_images(pictures).tobytes() == encoder.encode_images(pictures).tobytes()


def test_the_fingerprint_follows_the_weights(case: Case, encoder: Encoder, tmp_path: Path) -> None:
    other = encoders.load(case.other(tmp_path))
    assert other.fingerprint != encoder.fingerprint
    assert other.fingerprint.split("-")[0] == encoder.fingerprint.split("-")[0]


_BAD_PICTURES = [
    np.zeros((1, 8, 8, 3)),
    np.zeros((8, 8, 3), np.uint8),
    np.zeros((1, 8, 8, 4), np.uint8),
    np.zeros((1, 0, 8, 3), np.uint8),
    [[1]],
]


@pytest.mark.parametrize("images", _BAD_PICTURES)
def test_wrong_pictures_are_said(encoder: Encoder, images: object) -> None:
    with pytest.raises(BackendError, match="encode_images needs"):
        encoder.encode_images(images)  # type: ignore[arg-type]


@pytest.mark.parametrize("texts", ["chair", [1], [None]])
def test_wrong_texts_are_said(encoder: Encoder, texts: object) -> None:
    with pytest.raises(BackendError, match="list of strings"):
        encoder.encode_text(texts)  # type: ignore[arg-type]


def test_its_own_names_are_known_and_nothing_is_not(encoder: Encoder) -> None:
    for name in encoder.vocabulary.names:
        assert encoder.knows(name) and encoder.unknown_words(name) == ()
    assert not encoder.knows("") and not encoder.knows("the")
    assert set(encoder.unknown_words("zyzzyva chair")) <= {"zyzzyva"}


def test_its_rule_gives_probabilities(encoder: Encoder) -> None:
    things = encoder.encode_text(["chair", "table"])
    for name in ("chair", "a red table"):
        shares = probability(encoder, name, np.concatenate([things, np.zeros((1, encoder.dim))]))
        assert ((shares >= 0) & (shares <= 1)).all() and shares[2] == 0
    assert [name for name, _ in labels(encoder, things)] == ["chair", "table"]  # text vectors are nearest to themselves


def _noise(count: int, height: int, width: int) -> NDArray[np.uint8]:
    return np.random.default_rng(0).integers(0, 255, (count, height, width, 3)).astype(np.uint8)


def _nudge(path: Path) -> None:
    """Change one number of an ONNX graph's weights."""
    import onnx

    model = onnx.load(str(path))
    largest = max(model.graph.initializer, key=lambda t: len(t.raw_data))
    values = onnx.numpy_helper.to_array(largest).copy()
    values.flat[0] += 0.1
    largest.CopyFrom(onnx.numpy_helper.from_array(values, largest.name))
    path.write_bytes(model.SerializeToString())
