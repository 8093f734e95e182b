"""Selection with real CLIP vectors: things with real image vectors are queried with real text vectors.

The data (`clip_vectors`) are ViT-B/32 vectors of the 1,203 LVIS names and the mean over five photos of each class. They
bound what any selection by words can reach with such a model, so each of our figures is printed beside the one that the
vectors allow. The calibrated rule is the one that ships. Classes with an even LVIS id calibrate it (`calibrate`), those
with an odd id are measured. Each thing is one Gaussian.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray

from ..gaussians.camera import Camera
from ..gaussians.cloud import GaussianCloud
from ..gaussians.language import encoders
from ..gaussians.language.encoders import Encoder
from ..gaussians.language.encoders.backends.vectors import wrap
from ..gaussians.language.encoders.probability import labels, probability
from ..gaussians.language.encoders.vocabulary import Vocabulary
from ..gaussians.language.field.language_field import Group, LanguageField
from ..gaussians.language.query.query import Query
from ..gaussians.language.query.resolve import resolve
from ..gaussians.scene import Scene
from ..gaussians.world.box import Box

F64 = NDArray[np.float64]
Rows = NDArray[np.int64]

# The LVIS names of things found in rooms: furniture, appliances, and things on them.
ROOM = (
    "armchair", "bed", "bench", "bicycle", "bookcase", "cabinet", "chair", "clock", "coffee table", "curtain", "desk",
    "dresser", "flowerpot", "guitar", "lamp", "microwave oven", "mirror", "ottoman", "painting", "piano",
    "refrigerator", "sink", "sofa", "stool", "table", "television set", "trash can", "vase", "wardrobe",
)  # fmt: skip
NAMES = (40, 80, 300, 1203)  # vocabulary sizes for which one rule must work
THINGS, NAMELESS = 14, 4  # things in a simulated scene, and how many of them have no name in the vocabulary


@dataclass(frozen=True)
class Pairs:
    """Names with text vectors, and an image vector for each.

    Attributes:
        encoder: text vectors of all names, in the order of their ids.
        images: `[T, D]` unit mean image vector of each class, in the same order.
    """

    encoder: Encoder
    images: F64

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The names of all classes, as people say them."""
        return self.encoder.vocabulary.names

    @cached_property
    def texts(self) -> F64:
        """`[T, D]` unit text vectors."""
        return self.encoder.encode_text(list(self.names)).astype(np.float64)

    def half(self, odd: bool) -> Rows:
        """Classes with odd or with even ids; ids start at 1."""
        return np.arange(0 if odd else 1, len(self.names), 2)

    def among(self, rows: Rows) -> Encoder:
        """An encoder that has only these names."""
        if len(rows) == len(self.names):
            return self.encoder
        return wrap([(self.names[i],) for i in rows], self.texts[rows])


@dataclass(frozen=True)
class Scores:
    """The scores of queries in many scenes, for evaluation at any threshold.

    Attributes:
        present: `[P]` probability of the best thing for each name whose thing is there.
        right: `[P]` whether the best thing is the named one.
        absent: `[A]` probability of the best thing for each name whose thing is not there.
        top: `[P]` whether it is the named one by the raw cosine of the vectors.
    """

    present: F64
    right: NDArray[np.bool_]
    absent: F64
    top: NDArray[np.bool_]

    def wrongly_refused(self, threshold: float) -> float:
        """Share of the names whose thing is there that find nothing."""
        return float((self.present < threshold).mean())

    def refused(self, threshold: float) -> float:
        """Share of the names whose thing is not there that find nothing."""
        return float((self.absent < threshold).mean())

    def answered(self, threshold: float) -> float:
        """Share of the names whose thing is there that find it."""
        return float((self.right & (self.present >= threshold)).mean())


def load(data: Path) -> Pairs:
    """The vectors under `data/clip_vectors`."""
    folder = data / "clip_vectors"
    encoder = encoders.load(f"vectors:{folder}/lvis_v1_clip_a+cname.npy,{folder}/lvis_v1_train_cat_info.json")
    images = np.load(folder / "lvis_image_exemplar_features_avg_K-005_author.npy", allow_pickle=False)
    return Pairs(encoder, _unit(images.astype(np.float64)))


def room_rows(pairs: Pairs) -> Rows:
    """The classes of `ROOM`."""
    return np.array([pairs.names.index(name) for name in ROOM])


def named_rows(pairs: Pairs, vocabulary: Vocabulary) -> Rows:
    """The classes that mean what a name of the vocabulary means."""
    meant = (sorted(pairs.encoder.vocabulary.covered(name))[:1] for name in vocabulary.names)
    return np.array(sorted({pairs.names.index(name) for names in meant for name in names}))


def top1(pairs: Pairs, rows: Rows, step: int = 1) -> dict[str, float]:
    """Share of the things named right and of the names that find their thing, among the classes `rows`.

    "vectors" is the highest cosine, "ours" what `labels` and `probability` make of it. With `step`, only every such
    name is asked; all of them compete.
    """
    encoder, images = pairs.among(rows), pairs.images[rows]
    cosine = images @ pairs.texts[rows].T
    here = np.arange(len(rows))
    named = [name for name, _ in labels(encoder, images)]
    asked = [int(probability(encoder, pairs.names[i], images).argmax()) for i in rows[::step]]
    return {
        "named.vectors": float((cosine.argmax(axis=1) == here).mean()),
        "named.ours": float(np.mean([a == pairs.names[i] for a, i in zip(named, rows, strict=True)])),
        "asked.vectors": float((cosine.argmax(axis=0) == here)[::step].mean()),
        "asked.ours": float((np.array(asked) == here[::step]).mean()),
    }


def ask(
    pairs: Pairs, classes: Rows, vocabulary: int, scenes: int, things: int = THINGS, nameless: int = NAMELESS
) -> Scores:
    """Query simulated scenes of `things` of `classes`: all but `nameless` of them, and as many absent names.

    Args:
        vocabulary: how many names compete: the queried names and random others; the names of nameless things only if
            the vocabulary is the full one.
    """
    rng = np.random.default_rng(vocabulary)
    everything = np.arange(len(pairs.names))
    present: list[float] = []
    right: list[bool] = []
    absent: list[float] = []
    top: list[bool] = []
    for _ in range(scenes):
        drawn = rng.permutation(classes)
        asked = things - nameless
        inside, outside, away = np.split(drawn[: things + asked], [asked, things])
        others = rng.permutation(np.setdiff1d(everything, drawn[: things + asked]))
        rows = everything
        if vocabulary < len(everything):
            rows = np.concatenate([inside, away, others[: vocabulary - 2 * asked]])
        encoder, images = pairs.among(rows), pairs.images[np.concatenate([inside, outside])]
        for place, i in enumerate(inside):
            shares = probability(encoder, pairs.names[i], images)
            present.append(float(shares.max()))
            right.append(int(shares.argmax()) == place)
            top.append(int((images @ pairs.texts[i]).argmax()) == place)
        absent += [float(probability(encoder, pairs.names[i], images).max()) for i in away]
    return Scores(np.array(present), np.array(right), np.array(absent), np.array(top))


def ask_alike(pairs: Pairs, classes: Rows, competing: Rows, scenes: int) -> Scores:
    """Query scenes of similar things: `THINGS` of a few `classes` are present, and as many others are absent."""
    rng = np.random.default_rng(29)
    encoder = pairs.among(competing)
    found: list[tuple[float, bool, bool]] = []
    absent: list[float] = []
    for _ in range(scenes):
        drawn = rng.permutation(classes)
        inside, away = drawn[:THINGS], drawn[THINGS : 2 * THINGS]
        images = pairs.images[inside]
        for place, i in enumerate(inside):
            shares = probability(encoder, pairs.names[i], images)
            best = int((images @ pairs.texts[i]).argmax())
            found.append((float(shares.max()), int(shares.argmax()) == place, best == place))
        absent += [float(probability(encoder, pairs.names[i], images).max()) for i in away]
    present, right, top = (np.array(column) for column in zip(*found, strict=True))
    return Scores(present, right, np.array(absent), top)


def verdicts(pairs: Pairs, present: Rows, absent: Rows) -> dict[str, float]:
    """The same through `resolve`: a scene whose groups carry the image vectors, asked for "any" thing of a name."""
    scene = _scene(pairs, present)
    eye = Camera.look_at((0.0, -4.0, 1.0), (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 64, 64, 60.0)

    def group(row: int) -> int | None:
        answer = resolve(scene, Query(text=pairs.names[row], pick="any"), eye, pairs.encoder)
        return answer.groups[0] if answer.verdict == "found" else None

    there = [group(int(i)) for i in present]
    return {
        "right": float(np.mean([g == place for place, g in enumerate(there)])),
        "wrongly_refused": float(np.mean([g is None for g in there])),
        "refused": float(np.mean([group(int(i)) is None for i in absent])),
    }


def curve(scores: Sequence[Scores], thresholds: Sequence[float]) -> list[tuple[float, float, float]]:
    """`(threshold, share of present names answered right, share of absent names refused)`, means over the scores."""
    return [
        (t, float(np.mean([s.answered(t) for s in scores])), float(np.mean([s.refused(t) for s in scores])))
        for t in thresholds
    ]


def calibrate(pairs: Pairs, scenes: int = 100) -> tuple[float, float]:
    """The two numbers of `calibration.of_clip` from the even classes: the weight of the rivals and the threshold.

    The weight minimizes the log loss of the probabilities over things and names; the threshold minimizes the sum of the
    two errors over all vocabulary sizes and scenes of 14 and of 29 things.
    """
    even, rule = pairs.half(odd=False), pairs.encoder.calibration
    assert rule.rivals is not None
    rng = np.random.default_rng(0)
    logits, truths = [], []
    for _ in range(scenes):
        rows = rng.choice(even, THINGS, replace=False)
        for i in (*rows, *rng.choice(np.setdiff1d(even, rows), THINGS, replace=False)):
            shares = probability(pairs.encoder, pairs.names[i], pairs.images[rows]).clip(1e-12, 1 - 1e-12)
            logits.append(np.log(shares / (1 - shares)) + np.log(rule.rivals))  # how much better than the average name
            truths.append(rows == i)
    ratio, true = np.concatenate(logits), np.concatenate(truths)
    weights = np.exp(np.linspace(1, 8, 141))
    loss = [float(np.logaddexp(0, np.where(true, -1, 1) * (ratio - np.log(w))).mean()) for w in weights]
    weight = float(weights[int(np.argmin(loss))])
    asked = [ask(pairs, even, n, scenes) for n in NAMES]
    asked += [ask(pairs, even, n, scenes, things=29, nameless=5) for n in NAMES if n >= 60]
    grid = np.linspace(0.05, 0.9, 86)
    errors = [np.mean([1 - s.refused(t) + s.wrongly_refused(t) for s in asked]) for t in grid]
    return weight, float(grid[int(np.argmin(errors))])


def figures(data: Path, quick: bool = False) -> dict[str, float]:
    """Every figure by a dotted name; shares in [0, 1]."""
    pairs = load(data)
    threshold = pairs.encoder.calibration.threshold
    everything = np.arange(len(pairs.names))
    result = {f"room.{k}": v for k, v in top1(pairs, room_rows(pairs)).items()}
    result |= {f"all.{k}": v for k, v in top1(pairs, everything, 60 if quick else 1).items()}
    scenes = 10 if quick else 100
    scores = {f"names{n}": ask(pairs, pairs.half(odd=True), n, scenes) for n in NAMES}
    room, home = room_rows(pairs), named_rows(pairs, Vocabulary.household())
    scores["room29"] = ask_alike(pairs, room, room, scenes)
    scores["room1203"] = ask_alike(pairs, room, everything, scenes)
    scores["home.home"] = ask_alike(pairs, home, home, scenes)
    scores["home.everyday"] = ask_alike(pairs, home, named_rows(pairs, Vocabulary.everyday()), scenes)
    for key, score in scores.items():
        result[f"{key}.refused"] = score.refused(threshold)
        result[f"{key}.wrongly_refused"] = score.wrongly_refused(threshold)
        result[f"{key}.best.ours"] = float(score.right.mean())
        result[f"{key}.best.vectors"] = float(score.top.mean())
    rng = np.random.default_rng(7)
    drawn = [rng.permutation(pairs.half(odd=True))[: 2 * THINGS] for _ in range(scenes // 5)]
    answers = [verdicts(pairs, rows[:THINGS], rows[THINGS:]) for rows in drawn]
    return result | {f"resolve.{k}": float(np.mean([a[k] for a in answers])) for k in answers[0]}


def _scene(pairs: Pairs, rows: Rows) -> Scene:
    """One Gaussian, one group a class, in a line."""
    count = len(rows)
    means = torch.zeros(count, 3)
    means[:, 0] = torch.linspace(-2, 2, count)
    cloud = GaussianCloud.create(
        means, torch.tensor([1.0, 0, 0, 0]).repeat(count, 1), torch.full((count, 3), 0.05),
        torch.full((count,), 0.9), torch.zeros(count, 1, 3),
    )  # fmt: skip
    axes = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    groups = tuple(
        Group(i, "object", -1, "", 0.0, Box((float(x), 0.0, 0.0), axes, (0.1, 0.1, 0.1)), (50.0, 0.0, 0.0), 1, 1, 1.0)
        for i, x in enumerate(means[:, 0])
    )
    field = LanguageField(groups, pairs.images[rows].astype(np.float32), pairs.encoder.fingerprint, ())
    cloud = cloud.replace(group=torch.arange(count, dtype=torch.int32))
    return replace(Scene(cloud), language=field)


def _unit(rows: F64) -> F64:
    return rows / np.linalg.norm(rows, axis=1, keepdims=True)


if __name__ == "__main__":
    import sys

    folder = Path(sys.argv[1])
    print(json.dumps(figures(folder), indent=1))
    print("rivals and threshold from the even classes:", calibrate(load(folder)))
