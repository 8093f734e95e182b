"""Laws of affine colour maps: the same seen from any direction."""

from __future__ import annotations

import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from scenewright.gaussians.harmonics import evaluate
from scenewright.tools.color_map import ColorMap


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 3), st.integers(0, 10**6), st.booleans())
def test_the_map_commutes_with_looking_from_any_direction(degree: int, seed: int, each: bool) -> None:
    g = torch.Generator().manual_seed(seed)
    offset = torch.randn(*((40,) if each else ()), 3, generator=g, dtype=torch.float64)
    change = ColorMap(torch.randn(3, 3, generator=g, dtype=torch.float64), offset)
    sh = torch.randn(40, (degree + 1) ** 2, 3, generator=g, dtype=torch.float64)
    way = torch.nn.functional.normalize(torch.randn(40, 3, generator=g, dtype=torch.float64), dim=1)
    seen = evaluate(sh, way) + 0.5
    # Affine maps commute with sums of harmonics exactly; only rounding is left, scaled by the map's own size.
    assert torch.allclose(evaluate(change.on_harmonics(sh), way) + 0.5, change(seen), atol=1e-9)
