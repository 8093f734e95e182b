"""Laws of recolouring: exact in every direction, near the asked colour, texture kept, there and back again."""

from __future__ import annotations

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import Tensor

from scenewright.gaussians.color import parse, rgb_to_lab
from scenewright.gaussians.harmonics import evaluate
from scenewright.gaussians.language.field.measure import Sample, lightness_spread, lit_lab, mean_lab
from scenewright.tools.color_map import LUMA, NEAR, distance, saturation, toward_color, warmth

COLORS = ("teal", "white", "black", "gray", "yellow", "blue", "red", "olive", "pink", "brown")


def lab(name: str) -> Tensor:
    return rgb_to_lab(torch.tensor(parse(name), dtype=torch.float64))


def shaded(name: str, seed: int = 0, noise: float = 0.02) -> Sample:
    """An object of one colour in light and shadow, with a little noise."""
    g = torch.Generator().manual_seed(seed)
    light = 0.5 + 0.5 * torch.rand(1500, 1, generator=g, dtype=torch.float64)
    rgb = torch.tensor(parse(name), dtype=torch.float64) * light
    rgb = rgb + noise * torch.randn(1500, 3, generator=g, dtype=torch.float64)
    return Sample(rgb, torch.full((1500,), 1 / 1500, dtype=torch.float64))


@settings(max_examples=25, deadline=None)
@given(st.sampled_from(COLORS), st.sampled_from(COLORS), st.integers(0, 3), st.integers(0, 10**6))
def test_the_map_commutes_with_looking_from_any_direction(had: str, asked: str, degree: int, seed: int) -> None:
    change = toward_color(shaded(had), lab(asked))
    g = torch.Generator().manual_seed(seed)
    sh = torch.randn(40, (degree + 1) ** 2, 3, generator=g, dtype=torch.float64)
    way = torch.nn.functional.normalize(torch.randn(40, 3, generator=g, dtype=torch.float64), dim=1)
    seen = evaluate(sh, way) + 0.5
    repainted = evaluate(change.on_harmonics(sh), way) + 0.5
    # Affine maps commute with sums of harmonics exactly; only rounding is left, scaled by the map's own size.
    assert torch.allclose(repainted, change(seen), atol=1e-9 * float(change.matrix.abs().max()))


@pytest.mark.parametrize("had", COLORS)
@pytest.mark.parametrize("asked", COLORS)
def test_the_lit_faces_come_near_the_asked_colour_and_shading_stays(had: str, asked: str) -> None:
    before = shaded(had)
    change = toward_color(before, lab(asked))
    after = Sample(change(before.rgb), before.weight)
    assert float(distance(lit_lab(after), lab(asked))) < NEAR
    # A pure colour at the end of the display's range leaves little room; a fifth of the spread always fits.
    assert lightness_spread(after) > 0.2 * lightness_spread(before)


@pytest.mark.parametrize("asked", ["teal", "gray", "olive", "brown"])
def test_light_and_shadow_keep_their_order(asked: str) -> None:
    before = shaded("red", noise=0.0)
    after = toward_color(before, lab(asked))(before.rgb)
    order = (before.rgb @ torch.tensor(LUMA, dtype=torch.float64)).argsort()
    lightness = rgb_to_lab(after.clamp(0, 1))[order, 0]
    assert bool((lightness.diff() > -1e-6).all())


@pytest.mark.parametrize("asked", ["teal", "gray", "olive"])
def test_twice_is_once(asked: str) -> None:
    before = shaded("brown")
    once = Sample(toward_color(before, lab(asked))(before.rgb), before.weight)
    twice = toward_color(once, lab(asked))(once.rgb)
    moved = torch.linalg.vector_norm(rgb_to_lab(twice.clamp(0, 1)) - once.lab, dim=1)
    assert float(moved.mean()) < 2  # below what an eye tells apart (ΔE 2.3); the mean is fitted, not solved


@pytest.mark.parametrize("dark", ["#181818", "navy", "#302018"])
def test_dark_to_white_and_back_keeps_the_object(dark: str) -> None:
    before = shaded(dark, noise=0.01)
    white = Sample(toward_color(before, lab("white"))(before.rgb), before.weight)
    assert float(lit_lab(white)[0]) > 85
    back = Sample(toward_color(white, lit_lab(before))(white.rgb), white.weight)
    # The asked colour within 3 units and at least half of the shading: white has no room for all of it on the way.
    assert float(torch.linalg.vector_norm(lit_lab(back) - lit_lab(before))) < 3
    assert lightness_spread(back) > 0.5 * lightness_spread(before)


def test_a_pattern_stays_visible() -> None:
    stripes = shaded("red", noise=0.0)
    rgb = stripes.rgb.clone()
    rgb[::2] = torch.tensor([0.9, 0.9, 0.9], dtype=torch.float64)
    striped = Sample(rgb, stripes.weight)
    after = rgb_to_lab(toward_color(striped, lab("teal"))(rgb).clamp(0, 1))
    apart = torch.linalg.vector_norm(after[::2].mean(dim=0) - after[1::2].mean(dim=0))
    assert float(apart) > 15  # plainly two tones


@given(st.floats(0, 2.5))
def test_saturation_leaves_grey_and_luma_alone(factor: float) -> None:
    change, weights = saturation(factor), torch.tensor(LUMA, dtype=torch.float64)
    grey = torch.full((3,), 0.4, dtype=torch.float64)
    rgb = torch.rand(20, 3, generator=torch.Generator().manual_seed(0), dtype=torch.float64)
    # The weights sum to one to four digits, as the standard prints them.
    assert torch.allclose(change(grey), grey, atol=1e-9)
    assert torch.allclose(change(rgb) @ weights, rgb @ weights, atol=1e-9)


def test_warmth_moves_along_yellow_and_back() -> None:
    rgb = torch.full((1, 3), 0.5, dtype=torch.float64)
    assert float(rgb_to_lab(warmth(0.5)(rgb))[0, 2]) > 5 > -5 > float(rgb_to_lab(warmth(-0.5)(rgb))[0, 2])


def test_a_flat_colour_is_recoloured_without_dividing_by_its_spread() -> None:
    flat = Sample(torch.full((50, 3), 0.3, dtype=torch.float64), torch.full((50,), 0.02, dtype=torch.float64))
    change = toward_color(flat, lab("teal"))
    assert (
        bool(torch.isfinite(change.matrix).all())
        and float(distance(mean_lab(Sample(change(flat.rgb), flat.weight)), lab("teal"))) < 3
    )
