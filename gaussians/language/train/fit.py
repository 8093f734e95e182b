"""Teaches the two towers: each crop shall be nearest to a phrase for what it is, among phrases for everything else.

The loss is the question asked later (see `calibration.probability`): one phrase that is true of the picture against one
phrase for each kind it does not cover. Knows crops and captions. Refuses to know files.
"""

from __future__ import annotations

import copy
import math
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn
from torch.nn import functional

from ..encoders.embedded import tokenise
from ..encoders.vocabulary import Vocabulary
from . import captions
from .augment import augment
from .model import LENGTH, ImageTower, TextTower
from .renders import Crops

THINGS = 40  # a batch, each from all its views
MAX_SCALE = 40.0  # of the cosines: sharper would make the calibration brittle


@dataclass(frozen=True, eq=False)
class Task:
    """What is fixed while training.

    Attributes:
        vocabulary: kinds and non-objects.
        index: word to number.
        classes: all labels, kinds first.
        names: exact names of each label.
        broader: for each label the broader terms that are true of it.
        covers: phrase to `[C]` bool, the labels it must not compete with.
        modifiers: words put before names.
    """

    vocabulary: Vocabulary
    index: dict[str, int]
    classes: tuple[str, ...]
    names: dict[str, tuple[str, ...]]
    broader: dict[str, tuple[str, ...]]
    covers: dict[str, NDArray[np.bool_]]
    modifiers: list[str]


def task(vocabulary: Vocabulary, words: list[str]) -> Task:
    """Tables from the vocabulary and the word list."""
    classes = (*vocabulary.names, *vocabulary.negatives)
    names = {label: captions.names_of(vocabulary, label) for label in classes}
    pure = {t: k for t, k in vocabulary.broader.items() if t not in vocabulary.kinds}
    broader = {label: tuple(t for t, kinds in pure.items() if label in kinds) for label in classes}
    covers = {n: np.array([c == label for c in classes]) for label in classes for n in names[label]}
    covers.update({t: np.array([c in kinds for c in classes]) for t, kinds in pure.items()})
    index = {word: i + 1 for i, word in enumerate(words)}
    return Task(vocabulary, index, classes, names, broader, covers, sorted(vocabulary.modifiers))


@dataclass(frozen=True, eq=False)
class Towers:
    """The trained pair and the scale learnt with it."""

    image: ImageTower
    text: TextTower
    scale: float
    steps: int


def train(
    crops: Crops, job: Task, minutes: float, seed: int, report: Callable[[str], None], steps: int | None = None
) -> Towers:
    """Train for `minutes` of wall time (or exactly `steps`), returning the running mean of the weights.

    With `steps` the result depends on the seed alone (on one machine and torch version); by time it also depends on how
    many steps were done, which is recorded.
    """
    torch.manual_seed(seed)
    rng = np.random.default_rng(seed)
    image, text = ImageTower(), TextTower(len(job.index))
    image.to(memory_format=torch.channels_last)  # type: ignore[call-overload]  # twice as fast on CPUs
    log_scale = nn.Parameter(torch.tensor(math.log(12.0)))
    decayed = [p for m in (image, text) for p in m.parameters() if p.ndim > 1]
    plain = [p for m in (image, text) for p in m.parameters() if p.ndim <= 1] + [log_scale]
    optimizer = torch.optim.AdamW(
        [{"params": decayed, "weight_decay": 0.03}, {"params": plain, "weight_decay": 0.0}], lr=1e-3
    )
    mean = (copy.deepcopy(image), copy.deepcopy(text))
    label = np.array([job.classes.index(name) for name in crops.labels])
    weight = _balanced(label, len(job.classes))
    start, step, running = time.monotonic(), 0, math.log(len(job.classes))
    while (progress := step / steps if steps else (time.monotonic() - start) / (60 * minutes)) < 1:
        for group in optimizer.param_groups:
            group["lr"] = 2.5e-3 * min(1.0, (step + 1) / 60) * (0.5 + 0.5 * math.cos(math.pi * progress)) + 1e-5
        rows = rng.choice(len(crops), size=THINGS, p=weight)
        pictures = augment(torch.from_numpy(crops.pixels[rows]).flatten(0, 1), seed * 1_000_003 + step)
        vectors = image(pictures.contiguous(memory_format=torch.channels_last)).view(
            THINGS, -1, image.head.out_features
        )
        loss = _loss(vectors, text, log_scale.exp().clamp(max=MAX_SCALE), label[rows], job, rng)
        optimizer.zero_grad(set_to_none=True)
        loss.backward()  # type: ignore[no-untyped-call]
        nn.utils.clip_grad_norm_([*image.parameters(), *text.parameters()], 2.0)
        optimizer.step()
        _follow(mean, (image, text), min(0.998, (step + 1) / (step + 10)))
        running = 0.98 * running + 0.02 * float(loss.detach())
        step += 1
        if step % 100 == 0:
            report(f"step {step}, {100 * progress:.0f} %, loss {running:.3f}, scale {float(log_scale.exp()):.1f}")
    return Towers(mean[0].eval(), mean[1].eval(), float(log_scale.exp().clamp(max=MAX_SCALE)), step)


def _loss(
    vectors: Tensor, text: TextTower, scale: Tensor, label: NDArray[np.int64], job: Task, rng: np.random.Generator
) -> Tensor:
    """Cross-entropy of the true phrase against a phrase for every label it does not cover, for single views `[M, V, D]`
    and for means over a random number of them, and the other way round over the batch (Radford et al. 2021, with
    several positives a phrase)."""
    asked = [_true_phrase(job, int(k), rng) for k in label]
    own_text = [captions.phrase(rng, name, job.modifiers) for name in asked]
    class_text = [captions.phrase(rng, str(rng.choice(job.names[c])), job.modifiers) for c in job.classes]
    tokens = torch.from_numpy(tokenise([*own_text, *class_text], job.index, LENGTH))
    encoded = text(tokens)
    own, rivals = encoded[: len(asked)], encoded[len(asked) :]  # [M, D], [C, D]
    covered = torch.from_numpy(np.stack([job.covers[name] for name in asked]))  # [M, C]
    some = vectors[:, : int(rng.integers(2, vectors.shape[1] + 1))]
    pooled = functional.normalize(some.mean(dim=1, keepdim=True), dim=2)
    total = torch.zeros(())
    for seen, share in ((vectors, 0.5), (pooled, 0.5)):
        against = (scale * seen @ rivals.T).masked_fill(covered[:, None], -torch.inf)  # [M, V, C]
        logits = torch.cat([scale * (seen * own[:, None]).sum(dim=2, keepdim=True), against], dim=2)
        target = torch.zeros(logits.shape[:2], dtype=torch.long)
        total = total + share * functional.cross_entropy(logits.flatten(0, 1), target.flatten())
    across = scale * own @ pooled[:, 0].T  # [phrase, thing]
    fits = covered[:, torch.from_numpy(label)]  # [phrase, thing] bool
    hits = torch.logsumexp(across.masked_fill(~fits, -torch.inf), dim=1)
    return total + 0.25 * (torch.logsumexp(across, dim=1) - hits).mean()


def _true_phrase(job: Task, label: int, rng: np.random.Generator) -> str:
    """A name that is true of a label: its own, a synonym, or now and then a broader term."""
    name = job.classes[label]
    if job.broader[name] and rng.random() < 0.2:
        return str(rng.choice(job.broader[name]))
    return name if rng.random() < 0.4 else str(rng.choice(job.names[name]))


def _balanced(label: NDArray[np.int64], classes: int) -> NDArray[np.float64]:
    """Sampling weights `[M]`: every kind equally often, the frequent non-objects by the root of their number."""
    count = np.bincount(label, minlength=classes).astype(np.float64)
    typical = np.median(count[count > 0])
    share = np.where(count > typical, np.sqrt(count * typical), typical)
    weight = share[label] / count[label]
    result: NDArray[np.float64] = weight / weight.sum()
    return result


def _follow(mean: tuple[nn.Module, nn.Module], live: tuple[nn.Module, nn.Module], decay: float) -> None:
    """Move the running mean of weights and statistics towards the live ones."""
    with torch.no_grad():
        for slow, fast in zip(mean, live, strict=True):
            for a, b in zip(slow.state_dict().values(), fast.state_dict().values(), strict=True):
                if a.dtype.is_floating_point:
                    a.lerp_(b, 1 - decay)
                else:
                    a.copy_(b)
