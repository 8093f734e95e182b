"""The rule from similarity to probability, on an encoder small enough to check by hand; and the crop encoders see."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from scenewright.gaussians.errors import BackendError
from scenewright.gaussians.language.encoders import framing
from scenewright.gaussians.language.encoders.calibration import Calibration, SizePrior, of_clip
from scenewright.gaussians.language.encoders.probability import distribution, labels, probability
from scenewright.gaussians.language.encoders.vocabulary import Vocabulary
from scenewright.gaussians.world.words import normalise

_NAMES = ("mug", "bin", "chair", "part of something")
_SMALL = SizePrior((np.log(0.1), np.log(0.1), np.log(0.1)), (0.3, 0.3, 0.3))
_LARGE = SizePrior((np.log(0.4), np.log(0.4), np.log(0.5)), (0.3, 0.3, 0.3))


@dataclass(frozen=True, eq=False)
class _Axes:
    """Every name is its own axis, a synonym shares it, and "container" lies between mug and bin."""

    calibration: Calibration = field(default_factory=lambda: Calibration(8.0, 0.5, 1.0, {"mug": _SMALL, "bin": _LARGE}))
    fingerprint: str = "axes"
    dim: int = 4
    image_size: int = 8
    vocabulary: Vocabulary = field(
        default_factory=lambda: Vocabulary(
            {"mug": ("cup",), "bin": (), "chair": ()}, {"container": ("mug", "bin")}, ("part of something",)
        )
    )

    def encode_text(self, texts: list[str]) -> NDArray[np.float32]:
        axes = dict(zip(_NAMES, np.eye(4, dtype=np.float32), strict=True))
        axes |= {"cup": axes["mug"], "container": (axes["mug"] + axes["bin"]) / np.sqrt(2)}
        return np.stack([axes[t] for t in texts]) if texts else np.zeros((0, 4), np.float32)

    def encode_images(self, images: NDArray[np.uint8]) -> NDArray[np.float32]:
        raise NotImplementedError

    def unknown_words(self, text: str) -> tuple[str, ...]:
        return tuple(w for w in normalise(text) if w not in {"mug", "cup", "bin", "chair", "container"})

    def knows(self, text: str) -> bool:
        return bool(normalise(text)) and not self.unknown_words(text)


_AXES = _Axes()
_vectors = st.lists(st.floats(-1, 1), min_size=4, max_size=4).map(lambda v: np.array([v]))


@given(_vectors)
def test_names_share_out_one(vector: NDArray[np.float64]) -> None:
    share = distribution(_AXES, vector)
    expected = 0.0 if np.linalg.norm(vector) <= 1e-8 else 1.0
    assert np.isclose(share.sum(), expected) and (share >= 0).all()
    # For a canonical name the competition is the same one.
    each = [probability(_AXES, name, vector)[0] for name in ("mug", "bin", "chair")]
    np.testing.assert_allclose(each, share[0, :3], atol=1e-12)


@given(_vectors)
def test_a_synonym_is_worth_its_name_and_a_broader_term_does_not_fight_its_kinds(vector: NDArray[np.float64]) -> None:
    assert probability(_AXES, "cup", vector) == probability(_AXES, "mug", vector)
    mug = np.array([[1.0, 0, 0, 0]])
    rivals = np.exp([8 / np.sqrt(2), 0, 0])  # itself, chair and the non-object; neither mug nor bin
    assert np.isclose(probability(_AXES, "container", mug)[0], rivals[0] / rivals.sum())


def _weighed(rivals: float | None, negatives: tuple[str, ...]) -> _Axes:
    vocabulary = Vocabulary({"mug": (), "bin": (), "chair": ()}, {}, negatives)
    return _Axes(Calibration(8.0, 0.5, rivals=rivals), vocabulary=vocabulary)


@given(_vectors, st.floats(0.1, 100))
def test_weighed_rivals_count_the_same_however_many_they_are(vector: NDArray[np.float64], weight: float) -> None:
    rivals = ("bin", "chair", "part of something")
    seen = np.linalg.norm(vector) > 1e-8
    units = vector / np.linalg.norm(vector) if seen else vector
    ratio = np.exp(8 * units[0, 0]) / np.exp(8 * units[0, 1:]).mean()  # how much better than the average name
    expected = ratio / (ratio + weight) if seen else 0.0
    named = _weighed(weight, rivals[2:])
    np.testing.assert_allclose(probability(named, "mug", vector)[0], expected, atol=1e-12)
    # Naming every rival twice changes nothing; without a weight it would.
    doubled = _weighed(weight, (rivals[2], *rivals))
    np.testing.assert_allclose(probability(doubled, "mug", vector)[0], expected, atol=1e-12)
    # Each weighing one is the weight that equals their number.
    plain, counted = _weighed(None, rivals[2:]), _weighed(3.0, rivals[2:])
    np.testing.assert_allclose(probability(plain, "mug", vector), probability(counted, "mug", vector), atol=1e-12)


def test_size_decides_between_look_alikes() -> None:
    between = np.array([[1.0, 1.0, 0, 0], [1.0, 1.0, 0, 0], [1.0, 1.0, 0, 0]])
    sizes = np.array([[0.1, 0.1, 0.1], [0.4, 0.4, 0.5], [np.nan, 1, 1]])
    assert [name for name, _ in labels(_AXES, between, sizes)][:2] == ["mug", "bin"]
    unsized = probability(_AXES, "mug", between)
    assert probability(_AXES, "mug", between, sizes)[2] == unsized[2]  # an unknown size is no evidence
    turned = probability(_AXES, "bin", between, sizes[:, [1, 0, 2]])
    np.testing.assert_array_equal(turned, probability(_AXES, "bin", between, sizes))  # level sides are interchangeable


def test_unknown_words_and_unseen_things_get_nothing() -> None:
    assert (probability(_AXES, "spaceship", np.eye(4)) == 0).all()
    assert (probability(_AXES, "mug", np.zeros((3, 4))) == 0).all()
    assert labels(_AXES, np.zeros((1, 4))) == [("", 0.0)]
    assert labels(_AXES, np.zeros((0, 4))) == []


def test_bad_input_is_said() -> None:
    with pytest.raises(BackendError, match=r"shape \[G, 4\]"):
        probability(_AXES, "mug", np.zeros((2, 5)))
    with pytest.raises(BackendError, match="sizes must have shape"):
        probability(_AXES, "mug", np.eye(4), np.ones((2, 3)))
    for scale, threshold, weight in ((0, 0.5, 0), (1, 0, 0), (1, 1, 0), (1, 0.5, -1)):
        with pytest.raises(BackendError, match="broken calibration"):
            Calibration(scale, threshold, weight)
    with pytest.raises(BackendError, match="rivals must be > 0"):
        Calibration(1, 0.5, rivals=0)


def test_the_rule_survives_json() -> None:
    rule = _AXES.calibration
    assert Calibration.from_json(rule.to_json()) == rule
    assert Calibration.from_json(of_clip(77).to_json()) == of_clip(77)


@given(st.integers(0, 30), st.integers(0, 30), st.integers(1, 34), st.integers(1, 34))
def test_a_crop_centres_the_silhouette(top: int, left: int, height: int, width: int) -> None:
    alpha = torch.zeros(64, 64)
    alpha[top : top + height, left : left + width] = 1
    rgb = alpha[..., None].expand(64, 64, 3) * torch.tensor([1.0, 0.0, 0.0])
    rgba = framing.square_rgba(rgb, alpha, 48)
    assert rgba is not None and rgba.shape == (4, 48, 48)
    solid = rgba[3] > 0.5
    rows, columns = solid.nonzero().unbind(1)
    # Centred to a source pixel, which at most is 48 / 3 target pixels; the longer side leaves about the margin free.
    pixel = 48 / (max(height, width) + 2 * max(1, round(framing.MARGIN * max(height, width))))
    assert abs(float(rows.min() + rows.max()) - 47) <= 2 * pixel + 1
    assert abs(float(columns.min() + columns.max()) - 47) <= 2 * pixel + 1
    longer = max(int(rows.max() - rows.min()), int(columns.max() - columns.min())) + 1
    assert abs(longer - pixel * max(height, width)) <= 2  # one target pixel at each end


def test_an_empty_render_has_no_crop_and_the_background_is_neutral() -> None:
    assert framing.crop(torch.zeros(16, 16, 3), torch.zeros(16, 16), 8) is None
    alpha = torch.zeros(16, 16)
    alpha[4:12, 6:10] = 1
    picture = framing.crop(torch.zeros(16, 16, 3), alpha, 32)
    assert picture is not None and picture.dtype == np.uint8 and picture.shape == (32, 32, 3)
    assert (picture[0, 0] == 128).all() and (picture[16, 16] == 0).all()
