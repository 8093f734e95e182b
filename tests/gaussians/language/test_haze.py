"""The correction of the affinity rule in hazy scenes: none where a scene is clear, and what its fit recovers."""

from __future__ import annotations

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from scenewright.gaussians.assets import make
from scenewright.gaussians.language.segmentation.affinity import FEATURES
from scenewright.gaussians.language.segmentation.haze import (
    Correction,
    HazyRule,
    correction_inputs,
    correction_of,
    haze_of,
    load_correction,
)
from scenewright.gaussians.language.segmentation.learned_rule import load_rule
from scenewright.training.hazy_affinity import _logistic

RULE = load_rule("affinity", FEATURES)


def borders(seed: int, count: int = 200) -> np.ndarray:
    """Features of made-up borders, spread as those of the rule's rooms."""
    return RULE.mean + RULE.spread * np.random.default_rng(seed).normal(size=(count, len(FEATURES)))


def faded(opacity: float) -> float:
    """Haze of a chair whose Gaussians all have this opacity."""
    cloud = make("chair", 1).cloud
    same = cloud.replace(opacities=torch.full_like(cloud.opacities, opacity))
    return haze_of(same, np.arange(len(same)))


def test_opaque_scenes_are_clear_and_fainter_ones_are_hazier() -> None:
    assert faded(0.97) == 0 and faded(0.999) == 0
    haze = [faded(o) for o in (0.96, 0.9, 0.6, 0.3, 0.1, 0.02)]
    assert haze == sorted(haze) and haze[0] > 0 and 0.95 < haze[-2] < 1.1
    cloud = make("chair", 1).cloud
    assert haze_of(cloud, np.arange(len(cloud))) == 0  # things of our own are clear
    assert haze_of(cloud, np.zeros(0, np.int64)) == 0


@settings(max_examples=20)
@given(st.integers(0, 1000))
def test_without_haze_the_rule_holds_to_the_bit_and_a_little_haze_changes_little(seed: int) -> None:
    features, correction = borders(seed), load_correction("affinity", FEATURES)
    plain = RULE.probability(features)
    assert np.array_equal(HazyRule(RULE, correction, 0.0).probability(features), plain)
    near = HazyRule(RULE, correction, 1e-6).probability(features)
    assert np.abs(near - plain).max() < 1e-4  # the bound of the log-odds cuts probabilities at 5e-5


def test_in_haze_the_rule_is_less_sure() -> None:
    features = borders(3, 2000)
    clear, hazy = (HazyRule(RULE, load_correction("affinity", FEATURES), h).probability(features) for h in (0.0, 1.0))
    unsure = [((p > 0.02) & (p < 0.98)).mean() for p in (clear, hazy)]
    assert unsure[1] > 1.5 * unsure[0]


def test_the_correction_adds_what_it_says() -> None:
    features, weights = borders(5, 4), np.linspace(-1, 1, len(FEATURES))
    got = HazyRule(RULE, Correction(0.5, 0.25, weights), 0.8).probability(features)
    for row, p in zip(features, got, strict=True):  # slow reference, one border at a time
        likely = float(np.clip(RULE.probability(row), 1e-9, 1 - 1e-9))
        odds = min(max(np.log(likely / (1 - likely)), -10), 10)
        z = [min(max((v - m) / s, -3), 3) for v, m, s in zip(row, RULE.mean, RULE.spread, strict=True)]
        odds += 0.8 * (0.5 - 0.25 * odds + sum(w * x for w, x in zip(weights, z, strict=True)))
        assert p == pytest.approx(1 / (1 + np.exp(-odds)), abs=1e-9)


def test_a_fit_recovers_the_correction_that_made_the_answers() -> None:
    features, haze = borders(7, 20_000), 0.9
    true = np.concatenate([[1.2, 0.6], np.where(np.arange(len(FEATURES)) % 5 == 0, 0.5, 0.0)])
    odds, inputs = correction_inputs(RULE, features, haze)
    likely = 1 / (1 + np.exp(-(odds + inputs @ true)))
    same = (np.random.default_rng(8).random(len(likely)) < likely).astype(np.float64)
    found = _logistic(odds, inputs, same, np.ones(len(same)))
    assert np.abs(found - true).max() < 0.12  # four standard errors of a weight from 20,000 answers


def test_a_correction_is_refused_for_other_features() -> None:
    table = {"features": list(FEATURES), "constant": 0.0, "slope": 0.0, "weights": [0.0] * len(FEATURES)}
    assert correction_of(table, FEATURES).weights.shape == (len(FEATURES),)
    with pytest.raises(AssertionError, match="other features"):
        correction_of(table, FEATURES[1:])
