"""Laws of relative changes of colour: greys stay grey, ratios stay, nothing is clipped, the same in every direction."""

from __future__ import annotations

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import Tensor

from scenewright.gaussians.color import rgb_to_lab
from scenewright.gaussians.harmonics import SH_C0, color_to_dc, evaluate
from scenewright.gaussians.language.field.measure import Sample
from scenewright.tools.color_map import LUMA, ColorMap
from scenewright.tools.coloring import adjust
from scenewright.tools.coloring.greys import grey_shift
from scenewright.tools.coloring.seen import lit_face

WEIGHTS = torch.tensor(LUMA, dtype=torch.float64)
NEUTRAL = torch.ones(3, dtype=torch.float64)
AMOUNTS = st.floats(0.01, 1)
seeds = st.integers(0, 10**6)


def colors(seed: int, low: float = 0.0, high: float = 1.0, count: int = 400) -> Sample:
    g = torch.Generator().manual_seed(seed)
    rgb = low + (high - low) * torch.rand(count, 3, generator=g, dtype=torch.float64)
    return Sample(rgb, torch.full((count,), 1 / count, dtype=torch.float64))


def all_changes(sample: Sample, amount: float) -> list[adjust.Change]:
    return [
        adjust.darker(sample, amount), adjust.lighter(sample, amount), adjust.Saturation(1 + amount, NEUTRAL),
        adjust.Saturation(1 - amount, NEUTRAL), adjust.shown_warmth(sample, amount), adjust.Lift(1 + 3 * amount),
    ]  # fmt: skip


@settings(max_examples=30, deadline=None)
@given(seeds, AMOUNTS)
def test_darker_keeps_every_ratio_of_colours(seed: int, amount: float) -> None:
    before = colors(seed, 0.05)
    after = adjust.darker(before, amount)(before.rgb)
    ratio = after / before.rgb
    assert torch.allclose(ratio, ratio[0, 0].expand_as(ratio), rtol=1e-9)
    assert float(ratio[0, 0]) < 1


@settings(max_examples=30, deadline=None)
@given(seeds, AMOUNTS, st.booleans())
def test_greys_stay_grey(seed: int, amount: float, lighten: bool) -> None:
    g = torch.Generator().manual_seed(seed)
    grey = torch.rand(300, 1, generator=g, dtype=torch.float64).clamp(0.02, 0.98).expand(-1, 3)
    tinted = grey + 0.02 * torch.randn(300, 3, generator=g, dtype=torch.float64)
    before = Sample(torch.cat([tinted, colors(seed, count=100).rgb]), torch.full((400,), 1 / 400, dtype=torch.float64))
    change = adjust.lighter(before, amount) if lighten else adjust.darker(before, amount)
    pure = rgb_to_lab(change(grey).clamp(0, 1))
    # A pure grey stays a pure grey; the matrices of the standard are printed to seven digits.
    assert float(pure[:, 1:].abs().max()) < 1e-3
    assert grey_shift(before, Sample(change(before.rgb), before.weight)) < 2


@settings(max_examples=30, deadline=None)
@given(seeds, AMOUNTS)
def test_lighter_clips_nothing_and_keeps_the_order_of_greys(seed: int, amount: float) -> None:
    before = colors(seed)
    change = adjust.lighter(before, amount)
    # Colours that were at the end of the range may stay there.
    assert adjust.clipped(before.rgb, change(before.rgb), before.weight) == 0
    greys = torch.linspace(0, 0.98, 50, dtype=torch.float64)[:, None].expand(-1, 3)
    made = change(greys)[:, 0]
    assert bool((made.diff() > 0).all()) and bool((made >= greys[:, 0] - 1e-9).all())


def test_lighter_is_one_factor_where_there_is_room() -> None:
    dim = colors(0, 0.05, 0.3)
    change = adjust.lighter(dim, 0.5)
    assert isinstance(change, ColorMap)
    ratio = change(dim.rgb) / dim.rgb
    assert torch.allclose(ratio, ratio[0, 0].expand_as(ratio), rtol=1e-9)


@pytest.mark.parametrize("amount", [0.25, 0.5, 0.8])
@pytest.mark.parametrize("low, high", [(0.05, 0.3), (0.3, 0.6), (0.6, 0.95)])
def test_lighter_and_darker_move_the_lit_faces_as_far_as_the_amount_says(
    low: float, high: float, amount: float
) -> None:
    before = colors(1, low, high)
    was = float(lit_face(before)[0])
    dark = float(lit_face(Sample(adjust.darker(before, amount)(before.rgb), before.weight))[0])
    light = float(lit_face(Sample(adjust.lighter(before, amount)(before.rgb), before.weight))[0])
    # The factor is that of a grey; of mixed colours the lightness follows it within a fortieth of the scale.
    assert dark == pytest.approx(was * (1 - 0.75 * amount), abs=2.5)
    assert light > was + 0.3 * min(0.75 * amount * (100 - was), was)


@settings(max_examples=20, deadline=None)
@given(seeds, AMOUNTS, st.integers(0, 3))
def test_every_band_follows_the_constant_one(seed: int, amount: float, degree: int) -> None:
    """Seen from any direction, a Gaussian's colour is changed by the linear map that its mean colour is changed by."""
    sample = colors(seed, count=40)
    g = torch.Generator().manual_seed(seed)
    sh = 0.1 * torch.randn(40, (degree + 1) ** 2, 3, generator=g, dtype=torch.float64)
    sh[:, 0] = color_to_dc(sample.rgb)
    way = torch.nn.functional.normalize(torch.randn(40, 3, generator=g, dtype=torch.float64), dim=1)
    for change in all_changes(sample, amount):
        made = change.on_harmonics(sh)
        assert torch.allclose(made[:, 0] * SH_C0 + 0.5, change(sample.rgb), atol=1e-9)
        seen, now = evaluate(sh, way) + 0.5, evaluate(made, way) + 0.5
        if isinstance(change, ColorMap):
            assert torch.allclose(now, change(seen), atol=1e-9)
        # A shade of the mean colour, seen from somewhere, is the same shade of the changed mean colour.
        shade = sh.clone()
        shade[:, 1:] = sh[:, :1] * 0
        if degree:
            shade[:, 1] = 0.3 * (sh[:, 0] + 0.5 / SH_C0)
        factor = (evaluate(shade, way) + 0.5) / sample.rgb
        assert torch.allclose(evaluate(change.on_harmonics(shade), way) + 0.5, factor * change(sample.rgb), atol=1e-9)


def test_changes_of_nothing_change_nothing() -> None:
    g = torch.Generator().manual_seed(0)
    sh = torch.randn(20, 9, 3, generator=g)
    for change in (adjust.Lift(1.0), adjust.Saturation(1.0, NEUTRAL), adjust.warmth(0.0)):
        assert torch.allclose(change.on_harmonics(sh), sh, atol=1e-6)  # a few roundings of float32


@given(st.floats(0, 2.5), seeds)
@settings(max_examples=30, deadline=None)
def test_saturation_leaves_grey_and_luma_alone(factor: float, seed: int) -> None:
    change, rgb = adjust.Saturation(factor, NEUTRAL), colors(seed).rgb
    grey = torch.full((1, 3), 0.4, dtype=torch.float64)
    # The weights sum to one to four digits, as the standard prints them.
    assert torch.allclose(change(grey), grey, atol=1e-9)
    assert torch.allclose(change(rgb) @ WEIGHTS, rgb @ WEIGHTS, atol=1e-9)
    assert adjust.clipped(rgb, change(rgb), torch.ones(len(rgb))) == 0


def test_saturation_leaves_a_grey_of_the_scenes_light_alone() -> None:
    tint = torch.tensor([1.1, 0.99, 0.8], dtype=torch.float64)
    tint = tint / (tint @ WEIGHTS)
    wall = 0.6 * tint[None]
    assert torch.allclose(adjust.Saturation(2.0, tint)(wall), wall, atol=1e-9)


def test_warmth_moves_along_yellow_and_back() -> None:
    rgb = torch.full((1, 3), 0.5, dtype=torch.float64)
    assert float(rgb_to_lab(adjust.warmth(0.5)(rgb))[0, 2]) > 5 > -5 > float(rgb_to_lab(adjust.warmth(-0.5)(rgb))[0, 2])


def test_warmth_does_not_bleach_highlights() -> None:
    wall = Sample(torch.full((50, 3), 0.95, dtype=torch.float64), torch.full((50,), 0.02, dtype=torch.float64))
    assert float(adjust.shown_warmth(wall, 0.5)(wall.rgb).max()) < 1


def departures_kept(sample: Sample, share: float) -> Tensor:
    """Darkening as it once was: luma shrinks, departures from the mean hue stay as they are."""
    mean = sample.rgb.mean(dim=0)
    hue = mean / (mean @ WEIGHTS)
    own = (sample.rgb @ WEIGHTS)[:, None] * hue
    return share * own + (sample.rgb - own)


def test_the_measure_of_greys_sees_a_hue_shift() -> None:
    # A white and orange thing: kept departures turn its darkened white to blue.
    g = torch.Generator().manual_seed(0)
    light = 0.6 + 0.4 * torch.rand(200, 1, generator=g, dtype=torch.float64)
    rgb = light * torch.tensor([[0.9, 0.9, 0.9], [0.95, 0.6, 0.15]], dtype=torch.float64).repeat(100, 1)
    before = Sample(rgb, torch.full((200,), 1 / 200, dtype=torch.float64))
    assert grey_shift(before, Sample(departures_kept(before, 0.5), before.weight)) > 5
    assert grey_shift(before, Sample(adjust.darker(before, 0.5)(rgb), before.weight)) < 0.5
