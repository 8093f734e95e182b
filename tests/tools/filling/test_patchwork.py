"""Pictures with holes are filled by their own patches: texture goes on, surfaces keep apart, the rest stays."""

from __future__ import annotations

import numpy as np
from scipy import ndimage

from scenewright.tools.filling.behind.patchwork import patched

Y, X = np.mgrid[:60, :72]
HOLE = (np.abs(Y - 30) < 9) & (np.abs(X - 36) < 10)


def _filled(picture: np.ndarray) -> np.ndarray:
    return patched(np.where(HOLE[..., None], 0.0, picture), ~HOLE, HOLE)


def test_what_is_known_stays_and_the_same_input_gives_the_same_picture() -> None:
    picture = np.random.default_rng(0).random((60, 72, 3))
    one = _filled(picture)
    assert (one[~HOLE] == picture[~HOLE]).all() and (one == _filled(picture)).all()
    assert one[HOLE].min() >= 0 and one[HOLE].max() <= 1, "means of known colours"


def test_a_plain_picture_stays_plain() -> None:
    assert np.abs(_filled(np.full((60, 72, 3), 0.4)) - 0.4).max() < 1e-3


def test_texture_goes_on_instead_of_being_smeared() -> None:
    """Leaves: noise of a few pixels. The hole keeps most of its contrast; a smooth fill would keep none."""
    noise = ndimage.gaussian_filter(np.random.default_rng(1).normal(size=(60, 72)), 1.2)
    picture = np.repeat((0.5 + 0.15 * noise / noise.std())[..., None], 3, axis=2).clip(0, 1)
    out = _filled(picture)
    assert out[HOLE].std() > 0.6 * picture[HOLE].std()


def test_two_surfaces_keep_apart() -> None:
    """A dark and a bright half: the hole shows hardly anything between both."""
    picture = np.where((X < 36)[..., None], [0.1, 0.3, 0.1], [0.8, 0.8, 0.7])
    out = _filled(picture)
    between = (np.abs(out - [0.1, 0.3, 0.1]).max(axis=2) > 0.15) & (np.abs(out - [0.8, 0.8, 0.7]).max(axis=2) > 0.15)
    assert between[HOLE].mean() < 0.2


def test_nothing_known_or_nothing_missing_changes_nothing() -> None:
    picture = np.random.default_rng(2).random((20, 20, 3))
    none = np.zeros((20, 20), bool)
    assert (patched(picture, ~none, none) == picture).all()
    assert (patched(picture, none, ~none) == picture).all()
