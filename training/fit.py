"""Train the image and the text tower: crops and phrases are classified by cosine similarity to one vector per label."""

from __future__ import annotations

import copy
import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn
from torch.nn import functional

from ..gaussians.language.encoders.backends.embedded import tokenise
from ..gaussians.language.encoders.vocabulary import Vocabulary
from ..gaussians.world import kinds
from . import captions
from .augment import augment
from .model import DIM, LENGTH, ImageTower, TextTower
from .renders import Crops

THINGS = 64  # objects per batch
VIEWS_SHOWN = 2  # random views per object; more objects help more than more views
CAPTIONS = 192  # phrases per batch
PEAK_LR = 3e-3
FURTHER_SHARE = (
    0.5  # how often labels beyond the table of kinds are shown: they have few objects, which are soon learnt
)
NEGATIVE_SHARE = 2.5  # likewise for non-objects: wholeness weighs them against all names together
MAX_SCALE = 40.0  # of the cosines; higher scales make the calibration brittle


@dataclass(frozen=True, eq=False)
class Task:
    """Constant tables of the training.

    Attributes:
        vocabulary: kinds and non-objects.
        index: word to number.
        classes: all labels, kinds first.
        covers: for every name `[C]` bool, the labels that it applies to.
        modifiers: words that may precede names.
    """

    vocabulary: Vocabulary
    index: dict[str, int]
    classes: tuple[str, ...]
    covers: dict[str, NDArray[np.bool_]]
    modifiers: list[str]


def task(vocabulary: Vocabulary, words: list[str]) -> Task:
    """Build the tables from the vocabulary and the word list."""
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
    """The trained towers, the learnt scale of the cosines, and the number of steps."""

    image: ImageTower
    text: TextTower
    scale: float
    steps: int


@dataclass(frozen=True)
class Effort:
    """How long and how to train.

    Attributes:
        minutes: wall time, if `steps` is not given.
        steps: exact number of steps. The result then depends on the seed alone, on one machine and torch version.
        seed: of weights, batches, captions and augmentation.
        half: convolutions in bfloat16: twice as fast on processors that support it, slower on others.
        start: checkpoint of an earlier training with the same words and labels, to continue from.
        peak: highest learning rate.
    """

    minutes: float
    steps: int | None
    seed: int
    half: bool
    start: Path | None = None
    peak: float = PEAK_LR

    def progress(self, step: int, seconds: float) -> float:
        """Progress from 0 at the start to 1 at the end."""
        return step / self.steps if self.steps else seconds / (60 * self.minutes)


def train(crops: Crops, job: Task, effort: Effort, report: Callable[[str], None], keep: Path | None = None) -> Towers:
    """Train both towers and return the exponential moving average of their weights, which is also kept in the file
    `keep` for a later training to continue from."""
    torch.manual_seed(effort.seed)
    model = DualEncoder(len(job.index), len(job.classes))
    if effort.start is not None:
        model.load_state_dict(torch.load(effort.start, weights_only=True))
    model.image.to(memory_format=torch.channels_last)  # type: ignore[call-overload]  # twice as fast on CPUs
    mean = copy.deepcopy(model)
    optimizer = torch.optim.AdamW(
        [
            {"params": [p for p in model.parameters() if p.ndim > 1], "weight_decay": 0.03},
            {"params": [p for p in model.parameters() if p.ndim <= 1], "weight_decay": 0.0},
        ]
    )
    batches = Batches(crops, job, effort.seed)
    start, step, running = time.monotonic(), 0, math.log(len(job.classes))
    while (progress := effort.progress(step, time.monotonic() - start)) < 1:
        for group in optimizer.param_groups:
            group["lr"] = effort.peak * min(1.0, (step + 1) / 60) * (0.5 + 0.5 * math.cos(math.pi * progress)) + 1e-5
        loss, seen = _loss(model, batches, step, effort.half)
        optimizer.zero_grad(set_to_none=True)
        loss.backward()  # type: ignore[no-untyped-call]
        nn.utils.clip_grad_norm_(model.parameters(), 2.0)
        optimizer.step()
        _update_mean(mean, model, min(0.995, (step + 1) / (step + 10)))
        running = 0.98 * running + 0.02 * seen
        step += 1
        if step % 100 == 0:
            report(f"step {step}, {100 * progress:.0f} %, picture loss {running:.3f}, scale {model.scale.item():.1f}")
    if keep is not None:
        torch.save(mean.state_dict(), keep)
    return Towers(mean.image.eval(), mean.text.eval(), mean.scale.item(), step)


class DualEncoder(nn.Module):
    """Both towers, one unit vector per label, and the scale of the cosines.

    Images and phrases are pulled to the vector of their label and away from all others. The towers thus learn
    independently of each other, and images have no moving phrases as targets.
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
        """Scale of the cosines, at most `MAX_SCALE`."""
        return self.log_scale.exp().clamp(max=MAX_SCALE)


class Batches:
    """Batches of images and phrases. The same seed and step give the same batch."""

    def __init__(self, crops: Crops, job: Task, seed: int) -> None:
        self.crops, self.job, self.seed = crops, job, seed
        self.label = np.array([job.classes.index(name) for name in crops.labels])
        self.weight = sampling_weights(self.label, job.classes)
        covers = {name: row for name, row in job.covers.items() if row.any()}
        self.phrases = list(covers)
        self.covered = np.stack(list(covers.values()))  # [P, C]

    def pictures(self, step: int) -> tuple[Tensor, Tensor]:
        """`[THINGS * VIEWS_SHOWN, 3, S, S]` pictures and the label of each thing `[THINGS]`."""
        rng = np.random.default_rng([self.seed, step])
        rows = rng.choice(len(self.crops), size=THINGS, p=self.weight)
        views = np.argsort(rng.random((THINGS, self.crops.pixels.shape[1])), axis=1)[:, :VIEWS_SHOWN]
        shown = torch.from_numpy(self.crops.pixels[rows[:, None], views]).flatten(0, 1)
        pictures = augment(shown, self.seed * 1_000_003 + step).contiguous(memory_format=torch.channels_last)
        return pictures, torch.from_numpy(self.label[rows])

    def captions(self, step: int) -> tuple[Tensor, Tensor]:
        """Word numbers `[CAPTIONS, L]`, and `[CAPTIONS, C]` targets, uniform over the labels of a phrase."""
        rng = np.random.default_rng([self.seed, step, 1])
        rows = rng.integers(len(self.phrases), size=CAPTIONS)
        said = [captions.phrase(rng, self.phrases[i], self.job.modifiers) for i in rows]
        share = self.covered[rows] / self.covered[rows].sum(axis=1, keepdims=True)
        return torch.from_numpy(tokenise(said, self.job.index, LENGTH)), torch.from_numpy(share.astype(np.float32))


def _loss(model: DualEncoder, batches: Batches, step: int, half: bool) -> tuple[Tensor, float]:
    """Cross-entropy of single images, of means over views, and of phrases against the vectors of the labels.

    A cosine term also pulls phrases to the mean of their labels, since cross-entropy does not demand closeness.

    Returns:
        The loss, and the part of the images.
    """
    pictures, label = batches.pictures(step)
    with torch.autocast("cpu", torch.bfloat16, enabled=half):
        vectors = model.image(pictures)
    vectors = vectors.float().view(THINGS, VIEWS_SHOWN, -1)
    pooled = functional.normalize(vectors.mean(dim=1), dim=1)
    anchors, scale = model.anchors, model.scale
    single = functional.cross_entropy(scale * vectors.flatten(0, 1) @ anchors.T, label.repeat_interleave(VIEWS_SHOWN))
    seen = 0.5 * single + 0.5 * functional.cross_entropy(scale * pooled @ anchors.T, label)
    tokens, share = batches.captions(step)
    encoded, fixed = model.text(tokens), anchors.detach()
    said = functional.cross_entropy(scale.detach() * encoded @ fixed.T, share)
    near = (1 - (encoded * functional.normalize(share @ fixed, dim=1)).sum(dim=1)).mean()
    return seen + said + near, float(seen.detach())


def _often(label: str) -> float:
    """How often a label is shown, in relation to a kind of the table."""
    if label in captions.NEGATIVES:
        return NEGATIVE_SHARE
    return 1.0 if label in kinds.table().kinds else FURTHER_SHARE


def sampling_weights(label: NDArray[np.int64], classes: tuple[str, ...]) -> NDArray[np.float64]:
    """Sampling weights `[M]`: labels above the median count by the square root of it, the others equally often, each
    times how often such a label is shown."""
    often = np.array([_often(name) for name in classes])
    count = np.bincount(label, minlength=len(often)).astype(np.float64)
    typical = np.median(count[count > 0])
    share = np.where(count > typical, np.sqrt(count * typical), typical) * often
    weight = share[label] / count[label]
    result: NDArray[np.float64] = weight / weight.sum()
    return result


def _update_mean(mean: nn.Module, live: nn.Module, decay: float) -> None:
    """Update the moving average of weights and batch statistics."""
    with torch.no_grad():
        for slow, fast in zip(mean.state_dict().values(), live.state_dict().values(), strict=True):
            if slow.dtype.is_floating_point:
                slow.lerp_(fast, 1 - decay)
            else:
                slow.copy_(fast)
