"""The measuring of real CLIP vectors: laws on vectors made up here, and the shipped rule's figures on the real ones."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from scenewright.benchmarks import _clip
from scenewright.gaussians.language.encoders.backends.vectors import wrap
from scenewright.gaussians.language.encoders.calibration import of_clip
from scenewright.gaussians.language.encoders.probability import probability


def _made_up(noise: float) -> _clip.Pairs:
    """200 names, and things that look exactly like their names but for `noise` in every direction."""
    rng = np.random.default_rng(1)
    texts = rng.normal(size=(200, 32))
    encoder = wrap([(f"thing{i}",) for i in range(len(texts))], texts)
    images = encoder.rows + noise * rng.normal(size=texts.shape)
    return _clip.Pairs(encoder, images / np.linalg.norm(images, axis=1, keepdims=True))


@pytest.fixture(scope="module")
def real(data_dir: Path) -> _clip.Pairs:
    if not (data_dir / "clip_vectors").is_dir():
        pytest.skip(f"no clip_vectors in {data_dir}")
    return _clip.load(data_dir)


def test_perfect_vectors_are_never_wrong() -> None:
    pairs = _made_up(0.0)
    assert set(_clip.top1(pairs, np.arange(50)).values()) == {1.0}
    scores = _clip.ask(pairs, pairs.half(odd=True), 60, scenes=5, nameless=0)  # each thing is nearest to its own name
    threshold = of_clip().threshold
    assert scores.wrongly_refused(threshold) == 0 and scores.refused(threshold) == scores.answered(threshold) == 1
    found = _clip.verdicts(pairs, np.arange(10), np.arange(10, 30))
    assert found == {"right": 1.0, "wrongly_refused": 0.0, "refused": 1.0}


def test_a_higher_threshold_refuses_more() -> None:
    pairs = _made_up(0.35)
    scores = [_clip.ask(pairs, pairs.half(odd=False), n, scenes=5) for n in (60, 200)]
    rows = _clip.curve(scores, np.linspace(0, 1.01, 21).tolist())
    answered, refused = ([row[i] for row in rows] for i in (1, 2))
    assert answered == sorted(answered, reverse=True) and refused == sorted(refused)
    assert refused[0] == answered[-1] == 0 and refused[-1] == 1 and answered[0] > 0.2


def test_the_halves_are_apart() -> None:
    pairs = _made_up(0.0)
    assert sorted([*pairs.half(odd=True), *pairs.half(odd=False)]) == list(range(200))


@pytest.mark.slow
def test_names_are_no_worse_than_the_vectors_allow(real: _clip.Pairs) -> None:
    room = _clip.top1(real, _clip.room_rows(real))
    assert room["named.ours"] == room["named.vectors"] >= 0.9
    assert room["asked.ours"] >= room["asked.vectors"]
    everything = _clip.top1(real, np.arange(len(real.names)), step=40)
    # What the data's own description says; ties in half precision may turn one name of 1,203.
    assert everything["named.ours"] == everything["named.vectors"] == pytest.approx(0.629, abs=0.001)


def test_refusals_are_as_the_rule_says(real: _clip.Pairs) -> None:
    rule = real.encoder.calibration
    assert rule == of_clip()
    scores = _clip.ask(real, real.half(odd=True), 300, scenes=12)
    # 120 names asked and 120 absent: the standard errors are 0.027 and 0.021, so three of them.
    assert scores.wrongly_refused(rule.threshold) == pytest.approx(rule.measured["present_refused"], abs=0.08)
    assert scores.refused(rule.threshold) == pytest.approx(rule.measured["absent_refused"], abs=0.065)


def test_things_that_carry_the_vectors_of_their_labels_keep_to_the_same_rule(real: _clip.Pairs) -> None:
    """As masks with labels but no pictures give them: one name, or the mean of a majority and a minority."""
    rows = _clip.room_rows(real)
    encoder, texts, threshold = real.among(rows), real.texts[rows], of_clip().threshold
    asked = np.stack([probability(encoder, name, texts) for name in _clip.ROOM], axis=1)
    np.testing.assert_array_equal(asked >= threshold, np.eye(len(rows), dtype=bool))
    mixed = 0.7 * texts + 0.3 * np.roll(texts, 1, axis=0)
    voted = np.stack([probability(encoder, name, mixed) for name in _clip.ROOM], axis=1)
    np.testing.assert_array_equal(voted >= threshold, np.eye(len(rows), dtype=bool))


@pytest.mark.slow
def test_the_two_numbers_of_the_rule_come_from_the_even_classes(real: _clip.Pairs) -> None:
    weight, threshold = _clip.calibrate(real)
    assert weight == pytest.approx(of_clip().rivals, rel=0.01) and threshold == pytest.approx(of_clip().threshold)
