"""Text vectors from files: the layouts, which phrases they know, and that they say what they cannot do."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from safetensors.numpy import save_file

from scenewright.gaussians.errors import BackendError
from scenewright.gaussians.language import encoders
from scenewright.gaussians.language.encoders.calibration import Calibration
from scenewright.gaussians.language.encoders.probability import labels, probability, why_unknown

_NAMES = ["bicycle", "potted_plant", "couch", "cat"]
_ROWS = np.random.default_rng(5).normal(0, 3, (4, 8)).astype(np.float16)  # as published: half precision, not unit


def _folder(path: Path) -> str:
    np.save(path / "text.npy", _ROWS)
    (path / "names.json").write_text(json.dumps(_NAMES))
    return str(path)


def _lines(path: Path) -> str:
    np.save(path / "text.npy", _ROWS)
    (path / "names.txt").write_text("bicycle\n\npotted_plant, green thing\ncouch\ncat\n")
    return str(path)


def _pair(path: Path) -> str:
    np.save(path / "v.npy", _ROWS)
    entries = [{"id": i + 1, "name": n, "synonyms": [n], "def": "x"} for i, n in enumerate(_NAMES)]
    (path / "categories.json").write_text(json.dumps(entries[::-1]))  # rows follow the ids
    return f"{path / 'v.npy'},{path / 'categories.json'}"


def _npz(path: Path) -> str:
    np.savez(path / "v.npz", names=np.array(_NAMES), text=_ROWS)
    return str(path / "v.npz")


def _safetensors(path: Path) -> str:
    save_file({"text": _ROWS}, path / "v.safetensors", {"names": json.dumps(_NAMES)})
    return str(path / "v.safetensors")


_LAYOUTS: list[Callable[[Path], str]] = [_folder, _lines, _pair, _npz, _safetensors]


def _unit(rows: NDArray[np.floating]) -> NDArray[np.float64]:
    wide = rows.astype(np.float64)
    return wide / np.linalg.norm(wide, axis=1, keepdims=True)


@pytest.fixture(scope="module")
def vectors(tmp_path_factory: pytest.TempPathFactory) -> encoders.Encoder:
    return encoders.load(f"vectors:{_folder(tmp_path_factory.mktemp('vectors'))}")


@pytest.mark.parametrize("layout", _LAYOUTS)
def test_every_layout_gives_the_same_encoder(
    layout: Callable[[Path], str], tmp_path: Path, vectors: encoders.Encoder
) -> None:
    loaded = encoders.load(f"vectors:{layout(tmp_path)}")
    assert loaded.fingerprint == vectors.fingerprint
    expected = _unit(_ROWS)
    np.testing.assert_allclose(loaded.encode_text(["bicycle", "potted plant", "couch", "cat"]), expected, atol=1e-7)


def test_a_phrase_is_known_by_its_head(vectors: encoders.Encoder) -> None:
    rows = _unit(_ROWS)
    for phrase, row in (
        ("the red bicycles", 0), ("bike", 0), ("a houseplant", 1), ("plant", 1), ("small wooden sofa", 2),
    ):  # fmt: skip
        assert vectors.knows(phrase), phrase
        np.testing.assert_allclose(vectors.encode_text([phrase])[0], rows[row], atol=1e-7)
    assert vectors.unknown_words("purple cloth") == ("cloth",)
    assert vectors.unknown_words("bicycle helmet") == ("bicycle", "helmet")  # its head is the helmet
    for phrase in ("cloth", "", "the", "quixotic cat", "couch with wheels", "red"):
        assert not vectors.knows(phrase) and why_unknown(vectors, phrase) is not None, phrase
        assert (probability(vectors, phrase, _ROWS) == 0).all(), phrase
    with pytest.raises(BackendError, match=r"no vector for 'bicicle'.*did you mean bicycle"):
        vectors.encode_text(["bicicle"])


def test_brackets_tell_apart_and_the_bare_word_means_both(tmp_path: Path) -> None:
    np.save(tmp_path / "text.npy", _ROWS)
    (tmp_path / "names.json").write_text(
        json.dumps(["bow_(weapon)", "bow_(ribbons)", "mouse_(computer) pc_mouse", "cat"])
    )
    loaded = encoders.load(f"vectors:{tmp_path}")
    assert loaded.vocabulary.names == ("bow (weapon)", "bow (ribbons)", "mouse", "cat")
    assert loaded.vocabulary.covered("pc mouse") == {"mouse"}
    assert loaded.vocabulary.covered("bow") == {"bow (weapon)", "bow (ribbons)"}
    mean = _unit(_ROWS)[:2].mean(axis=0, keepdims=True)
    np.testing.assert_allclose(loaded.encode_text(["the bow"]), _unit(mean), atol=1e-7)


def test_a_vector_is_called_by_its_own_name(vectors: encoders.Encoder) -> None:
    assert [name for name, _ in labels(vectors, _ROWS)] == ["bicycle", "potted plant", "couch", "cat"]


def test_pictures_are_refused_with_what_to_do(vectors: encoders.Encoder) -> None:
    with pytest.raises(BackendError, match="embed from masks"):
        vectors.encode_images(np.zeros((1, 8, 8, 3), np.uint8))
    assert vectors.encode_images(np.zeros((0, 8, 8, 3), np.uint8)).shape == (0, 8)


def test_a_rule_beside_the_vectors_is_used(tmp_path: Path) -> None:
    argument = _folder(tmp_path)
    (tmp_path / "calibration.json").write_text(json.dumps({"scale": 17.0, "threshold": 0.4}))
    assert encoders.load(f"vectors:{argument}").calibration == Calibration(17.0, 0.4)
    (tmp_path / "calibration.json").write_text("{}")
    with pytest.raises(BackendError, match="is not a calibration"):
        encoders.load(f"vectors:{argument}")


def _write(path: Path, names: str, rows: NDArray[np.floating] = _ROWS) -> str:
    np.save(path / "text.npy", rows)
    (path / "names.json").write_text(names)
    return f"vectors:{path}"


@pytest.mark.parametrize(
    ("names", "rows", "said"),
    [
        ("[", _ROWS, "cannot be read"),
        ('{"a": 1}', _ROWS, "must be a list"),
        ('["a", 3, "b", "c"]', _ROWS, "must be a list"),
        ('["a", "b", "c"]', _ROWS, "need as many"),
        ('["a", "b", "c", "a"]', _ROWS, "'a' occurs twice"),
        (json.dumps(_NAMES), _ROWS * 0, "zero or not finite"),
        (json.dumps(_NAMES), _ROWS[0], "need as many"),
    ],
)
def test_broken_files_are_said(tmp_path: Path, names: str, rows: NDArray[np.floating], said: str) -> None:
    with pytest.raises(BackendError, match=said):
        encoders.load(_write(tmp_path, names, rows))


def test_missing_files_are_said(tmp_path: Path) -> None:
    for spec, said in (
        ("vectors:", "name the vectors"),
        (f"vectors:{tmp_path}", r"names\.json"),
        (f"vectors:{tmp_path}/no.npz", "needs the arrays"),
        (f"vectors:{tmp_path}/no.safetensors", "needs a tensor"),
        (f"vectors:{tmp_path}/no.bin", "holds no vectors"),
        (f"vectors:{tmp_path}/no.npy,{tmp_path}/no.json", "cannot be read as a list"),
    ):
        with pytest.raises(BackendError, match=said):
            encoders.load(spec)
    (tmp_path / "names.txt").write_text("a\n")
    (tmp_path / "text.npy").write_bytes(b"not an array")
    with pytest.raises(BackendError, match="cannot be read as an array"):
        encoders.load(f"vectors:{tmp_path}")
    np.savez(tmp_path / "half.npz", text=_ROWS)
    with pytest.raises(BackendError, match="needs the arrays names"):
        encoders.load(f"vectors:{tmp_path / 'half.npz'}")
