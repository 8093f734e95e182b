"""Train the two towers contrastively: each crop and each phrase shall be nearest to its own label among all labels."""

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

from ..gaussians.language.encoders.backends.embedded import tokenise
from ..gaussians.language.encoders.vocabulary import Vocabulary
from . import captions
from .augment import augment
from .model import DIM, LENGTH, ImageTower, TextTower
from .renders import Crops

THINGS = 64  # a batch
SHOWN = 2  # of the views of each, chosen anew each time: more things teach more than more views
CAPTIONS = 192  # phrases a batch
PEAK = 3e-3  # learning rate
MAX_SCALE = 40.0  # of the cosines: sharper would make the calibration brittle


@dataclass(frozen=True, eq=False)
class Task:
    """What is fixed while training.

    Attributes:
        vocabulary: kinds and non-objects.
        index: word to number.
        classes: all labels, kinds first.
        covers: every name to `[C]` bool, the labels it is true of.
        modifiers: words put before names.
    """

    vocabulary: Vocabulary
    index: dict[str, int]
    classes: tuple[str, ...]
    covers: dict[str, NDArray[np.bool_]]
    modifiers: list[str]


def task(vocabulary: Vocabulary, words: list[str]) -> Task:
    """Tables from the vocabulary and the word list."""
    classes = (*vocabulary.names, *vocabulary.negatives)
    pure = {t: k for t, k in vocabulary.broader.items() if t not in vocabulary.kinds}
    covers = {t: np.array([c in kinds for c in classes]) for t, kinds in pure.items()}
    covers |= {
        n: np.array([c == label for c in classes]) for label in classes for n in captions.names_of(vocabulary, label)
    }
    index = {word: i + 1 for i, word in enumerate(words)}
    return Task(vocabulary, index, classes, covers, sorted(vocabulary.modifiers))


@dataclass(frozen=True, eq=False)
class Towers:
    """The trained pair and the scale learnt with it."""

    image: ImageTower
    text: TextTower
    scale: float
    steps: int


@dataclass(frozen=True)
class Effort:
    """How long and how to train.

    Attributes:
        minutes: of wall time, if `steps` is not given.
        steps: exactly so many. The result then depends on the seed alone, on one machine and torch version.
        seed: of weights, batches, captions and augmentation.
        half: convolutions in bfloat16: twice as fast on processors that know it, slower on others.
    """

    minutes: float
    steps: int | None
    seed: int
    half: bool

    def progress(self, step: int, seconds: float) -> float:
        """0 at the start, 1 when it is over."""
        return step / self.steps if self.steps else seconds / (60 * self.minutes)


def train(crops: Crops, job: Task, effort: Effort, report: Callable[[str], None]) -> Towers:
    """Train both towers; what is returned is the running mean of their weights."""
    torch.manual_seed(effort.seed)
    pupil = Pupil(len(job.index), len(job.classes))
    pupil.image.to(memory_format=torch.channels_last)  # type: ignore[call-overload]  # twice as fast on CPUs
    mean = copy.deepcopy(pupil)
    optimizer = torch.optim.AdamW(
        [
            {"params": [p for p in pupil.parameters() if p.ndim > 1], "weight_decay": 0.03},
            {"params": [p for p in pupil.parameters() if p.ndim <= 1], "weight_decay": 0.0},
        ]
    )
    lessons = Lessons(crops, job, effort.seed)
    start, step, running = time.monotonic(), 0, math.log(len(job.classes))
    while (progress := effort.progress(step, time.monotonic() - start)) < 1:
        for group in optimizer.param_groups:
            group["lr"] = PEAK * min(1.0, (step + 1) / 60) * (0.5 + 0.5 * math.cos(math.pi * progress)) + 1e-5
        loss, seen = _loss(pupil, lessons, step, effort.half)
        optimizer.zero_grad(set_to_none=True)
        loss.backward()  # type: ignore[no-untyped-call]
        nn.utils.clip_grad_norm_(pupil.parameters(), 2.0)
        optimizer.step()
        _follow(mean, pupil, min(0.995, (step + 1) / (step + 10)))
        running = 0.98 * running + 0.02 * seen
        step += 1
        if step % 100 == 0:
            report(f"step {step}, {100 * progress:.0f} %, picture loss {running:.3f}, scale {pupil.scale.item():.1f}")
    return Towers(mean.image.eval(), mean.text.eval(), mean.scale.item(), step)


class Pupil(nn.Module):
    """Both towers and what ties them: one unit vector a label, and the scale of the cosines.

    Pictures are drawn to the vector of their label and away from all others; so are phrases. Each tower then learns at
    its own pace, instead of pictures chasing phrases that are themselves still moving.
    """

    def __init__(self, words: int, labels: int) -> None:
        super().__init__()
        self.image, self.text = ImageTower(), TextTower(words)
        self.table = nn.Parameter(torch.randn(labels, DIM))
        self.log_scale = nn.Parameter(torch.tensor(math.log(12.0)))

    @property
    def anchors(self) -> Tensor:
        """`[C, D]` unit rows."""
        return functional.normalize(self.table, dim=1)

    @property
    def scale(self) -> Tensor:
        """Of the cosines, at most `MAX_SCALE`."""
        return self.log_scale.exp().clamp(max=MAX_SCALE)


class Lessons:
    """Batches of pictures and phrases; the same seed and step give the same batch."""

    def __init__(self, crops: Crops, job: Task, seed: int) -> None:
        self.crops, self.job, self.seed = crops, job, seed
        self.label = np.array([job.classes.index(name) for name in crops.labels])
        self.weight = _balanced(self.label, len(job.classes))
        covers = {name: row for name, row in job.covers.items() if row.any()}
        self.phrases = list(covers)
        self.covered = np.stack(list(covers.values()))  # [P, C]

    def pictures(self, step: int) -> tuple[Tensor, Tensor]:
        """`[THINGS * SHOWN, 3, S, S]` pictures and the label of each thing `[THINGS]`."""
        rng = np.random.default_rng([self.seed, step])
        rows = rng.choice(len(self.crops), size=THINGS, p=self.weight)
        views = np.argsort(rng.random((THINGS, self.crops.pixels.shape[1])), axis=1)[:, :SHOWN]
        shown = torch.from_numpy(self.crops.pixels[rows[:, None], views]).flatten(0, 1)
        pictures = augment(shown, self.seed * 1_000_003 + step).contiguous(memory_format=torch.channels_last)
        return pictures, torch.from_numpy(self.label[rows])

    def captions(self, step: int) -> tuple[Tensor, Tensor]:
        """Word numbers `[CAPTIONS, L]`, and the share of each label in what a phrase covers `[CAPTIONS, C]`."""
        rng = np.random.default_rng([self.seed, step, 1])
        rows = rng.integers(len(self.phrases), size=CAPTIONS)
        said = [captions.phrase(rng, self.phrases[i], self.job.modifiers) for i in rows]
        share = self.covered[rows] / self.covered[rows].sum(axis=1, keepdims=True)
        return torch.from_numpy(tokenise(said, self.job.index, LENGTH)), torch.from_numpy(share.astype(np.float32))


def _loss(pupil: Pupil, lessons: Lessons, step: int, half: bool) -> tuple[Tensor, float]:
    """Cross-entropy of single pictures and of means over views against the labels' vectors, and of phrases likewise;
    phrases shall also lie close to what they cover, since the scale alone does not demand it. The second number is the
    pictures' part."""
    pictures, label = lessons.pictures(step)
    with torch.autocast("cpu", torch.bfloat16, enabled=half):
        vectors = pupil.image(pictures)
    vectors = vectors.float().view(THINGS, SHOWN, -1)
    pooled = functional.normalize(vectors.mean(dim=1), dim=1)
    anchors, scale = pupil.anchors, pupil.scale
    single = functional.cross_entropy(scale * vectors.flatten(0, 1) @ anchors.T, label.repeat_interleave(SHOWN))
    seen = 0.5 * single + 0.5 * functional.cross_entropy(scale * pooled @ anchors.T, label)
    tokens, share = lessons.captions(step)
    encoded, fixed = pupil.text(tokens), anchors.detach()
    said = functional.cross_entropy(scale.detach() * encoded @ fixed.T, share)
    near = (1 - (encoded * functional.normalize(share @ fixed, dim=1)).sum(dim=1)).mean()
    return seen + said + near, float(seen.detach())


def _balanced(label: NDArray[np.int64], classes: int) -> NDArray[np.float64]:
    """Sampling weights `[M]`: every kind equally often, the frequent non-objects by the root of their number."""
    count = np.bincount(label, minlength=classes).astype(np.float64)
    typical = np.median(count[count > 0])
    share = np.where(count > typical, np.sqrt(count * typical), typical)
    weight = share[label] / count[label]
    result: NDArray[np.float64] = weight / weight.sum()
    return result


def _follow(mean: nn.Module, live: nn.Module, decay: float) -> None:
    """Move the running mean of weights and statistics towards the live ones."""
    with torch.no_grad():
        for slow, fast in zip(mean.state_dict().values(), live.state_dict().values(), strict=True):
            if slow.dtype.is_floating_point:
                slow.lerp_(fast, 1 - decay)
            else:
                slow.copy_(fast)
