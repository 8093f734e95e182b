"""Turn the network's logits into probabilities: a scale and a shift, fitted to crops that it has not learnt from (Platt
1999) and folded into the finest head."""

from __future__ import annotations

from copy import deepcopy

import numpy as np
import torch
from torch import nn
from torch.nn import functional

from .augment import sample
from .dataset import Pictures
from .model import Contours

CROPS = 96
SIDE = 192
KEPT = 40_000  # pixels of each batch that are looked at


def calibrated(net: Contours, data: Pictures, seed: int) -> Contours:
    """A copy of the network whose probabilities fit crops of `data`, changed as in training."""
    scale, shift = _fitted(*_logits(net, data, seed))
    result = deepcopy(net)
    head = result.heads[0]
    assert isinstance(head, nn.Conv2d) and head.bias is not None
    with torch.no_grad():
        head.weight.mul_(scale)
        head.bias.mul_(scale).add_(shift)
    return result


def _logits(net: Contours, data: Pictures, seed: int) -> tuple[torch.Tensor, torch.Tensor]:
    """Logits and truth `[M]` of random pixels."""
    rng = np.random.default_rng([seed, 9])
    logits, truth = [], []
    with torch.inference_mode():
        for _ in range(CROPS // 8):
            samples = [sample(data, rng, SIDE) for _ in range(8)]
            out = net(torch.from_numpy(np.stack([s.channels for s in samples])))[0][:, 0].numpy().reshape(-1)
            border = np.stack([s.border for s in samples]).reshape(-1)
            at = rng.permutation(np.flatnonzero(border != 2))[:KEPT]
            logits.append(out[at])
            truth.append(border[at])
    return torch.from_numpy(np.concatenate(logits)), torch.from_numpy(np.concatenate(truth).astype(np.float32))


def _fitted(logits: torch.Tensor, truth: torch.Tensor) -> tuple[float, float]:
    """Scale and shift of the least cross entropy, by Newton's method in double precision."""
    x = torch.stack([logits.double(), torch.ones_like(logits, dtype=torch.float64)], dim=1)  # [M, 2]
    w = torch.tensor([1.0, 0.0], dtype=torch.float64)
    for _ in range(30):
        p = torch.sigmoid(x @ w)
        gradient = x.T @ (p - truth)
        curvature = (x * (p * (1 - p))[:, None]).T @ x + 1e-6 * torch.eye(2, dtype=torch.float64)
        step = torch.linalg.solve(curvature, gradient)
        w = w - step / max(1.0, float(step.abs().max()))
    return float(w[0]), float(w[1])


def reliability(net: Contours, data: Pictures, seed: int) -> dict[str, list[float]]:
    """Share of true borders among pixels of each tenth of probability, and the cross entropy of all."""
    logits, truth = _logits(net, data, seed)
    p = torch.sigmoid(logits)
    tenth = (p * 10).long().clamp(max=9)
    shares = [float(truth[tenth == k].mean()) if (tenth == k).any() else float("nan") for k in range(10)]
    entropy = float(functional.binary_cross_entropy(p, truth))
    return {"share_of_borders": [round(s, 3) for s in shares], "cross_entropy": [round(entropy, 4)]}
