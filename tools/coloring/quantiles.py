"""Weighted quantiles of sampled values."""

from __future__ import annotations

import torch
from torch import Tensor


def quantile(values: Tensor, weight: Tensor, q: float) -> float:
    """The smallest of the values `[M]`, M > 0, at or below which a share `q` of the weight `[M]` lies."""
    ordered, order = values.sort()
    total = weight[order].cumsum(dim=0)
    index = int(torch.searchsorted(total, q * total[-1:]).clamp(max=len(values) - 1))
    return float(ordered[index])
