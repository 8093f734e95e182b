"""Train the contour network on crops that are drawn on the fly, with weighted cross entropy and averaged weights."""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from copy import deepcopy
from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor, nn
from torch.nn import functional

from .augment import sample
from .dataset import Pictures
from .model import Contours

PEAK = 2.5e-3  # learning rate of AdamW
DECAY = 1e-3  # weight decay
MEAN = 0.998  # of the moving average of the weights
RARE = 2.5  # weight of border pixels in the cross entropy
COARSE = 0.3  # weight of each coarser head
WARM = 0.08  # share of the run over which the rate rises


@dataclass(frozen=True)
class Effort:
    """How long and with what to train; `steps` wins over `minutes`."""

    minutes: float
    steps: int | None
    seed: int
    side: int = 192
    batch: int = 8
    half: bool = False


@dataclass(frozen=True, eq=False)
class Trained:
    """The averaged network, the steps it took and the last mean loss."""

    net: Contours
    steps: int
    loss: float


def loss_of(outputs: list[Tensor], border: Tensor) -> Tensor:
    """Mean over the heads; `border [B, S, S]` holds 0, 1, and 2 where the loss is not counted."""
    total = torch.zeros(())
    target, known = (border == 1).float()[:, None], (border != 2).float()[:, None]
    for level, logits in enumerate(outputs):
        if level:
            target, known = functional.max_pool2d(target, 2), 1 - functional.max_pool2d(1 - known, 2)
        weight = known * (1 + (RARE - 1) * target)
        entropy = functional.binary_cross_entropy_with_logits(logits.float(), target, weight, reduction="sum")
        sure = torch.sigmoid(logits.float()) * known
        both, either = (sure * target).sum(dim=(1, 2, 3)), (sure.square() + target * known).sum(dim=(1, 2, 3))
        overlap = 1 - ((2 * both + 20) / (either + 20)).mean()
        part = entropy / weight.sum().clamp(min=1) + 0.3 * overlap
        total = total + part * (1.0 if level == 0 else COARSE)
    return total


def train(data: Pictures, effort: Effort, report: Callable[[str], None], start: Contours | None = None) -> Trained:
    """Train from scratch, or go on from the weights of `start`. With fixed steps the seed decides the result."""
    torch.manual_seed(effort.seed)
    net = Contours() if start is None else deepcopy(start)
    net = net.to(memory_format=torch.channels_last).train()  # type: ignore[call-overload]
    mean = deepcopy(net)
    optimizer = torch.optim.AdamW(net.parameters(), lr=PEAK, weight_decay=DECAY)
    begun, step, running = time.monotonic(), 0, 0.0
    with ThreadPoolExecutor(1) as pool:
        ahead = pool.submit(_batch, data, effort, 0)
        while (done := _progress(effort, step, begun)) < 1:
            channels, border = ahead.result()
            ahead = pool.submit(_batch, data, effort, step + 1)
            for group in optimizer.param_groups:
                group["lr"] = PEAK * _rate(done)
            with torch.autocast("cpu", torch.bfloat16, enabled=effort.half):
                outputs = net(channels)
            loss = loss_of(outputs, border)
            optimizer.zero_grad(set_to_none=True)
            loss.backward()  # type: ignore[no-untyped-call]
            nn.utils.clip_grad_norm_(net.parameters(), 2.0)
            optimizer.step()
            _average(mean, net, min(MEAN, (1 + step) / (10 + step)))
            step += 1
            running = float(loss.detach()) if step == 1 else 0.98 * running + 0.02 * float(loss.detach())
            if step % 50 == 0:
                report(f"step {step}, {done:4.0%}, loss {running:.4f}")
    return Trained(mean.eval(), step, running)


def _batch(data: Pictures, effort: Effort, step: int) -> tuple[Tensor, Tensor]:
    rng = np.random.default_rng([effort.seed, 5, step])
    samples = [sample(data, rng, effort.side) for _ in range(effort.batch)]
    channels = torch.from_numpy(np.stack([s.channels for s in samples])).to(memory_format=torch.channels_last)
    return channels, torch.from_numpy(np.stack([s.border for s in samples]))


def _progress(effort: Effort, step: int, begun: float) -> float:
    if effort.steps is not None:
        return step / max(1, effort.steps)
    return (time.monotonic() - begun) / (60 * effort.minutes)


def _rate(done: float) -> float:
    """One cycle: a linear rise, then half a cosine down to a hundredth."""
    if done < WARM:
        return 0.05 + 0.95 * done / WARM
    t = (done - WARM) / (1 - WARM)
    return float(0.01 + 0.99 * (0.5 + 0.5 * np.cos(np.pi * t)))


def _average(mean: nn.Module, net: nn.Module, keep: float) -> None:
    """Move the averaged weights towards the current ones; counters are copied."""
    with torch.no_grad():
        for a, b in zip(mean.state_dict().values(), net.state_dict().values(), strict=True):
            if a.dtype.is_floating_point:
                a.lerp_(b, 1 - keep)
            else:
                a.copy_(b)
