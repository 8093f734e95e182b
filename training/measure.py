"""Evaluate the encoder on unseen objects, and fit its calibration: scale, weight of sizes and threshold.

All vectors are computed by the exported encoder, not by torch.
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..gaussians.language.encoders import Encoder
from ..gaussians.language.encoders.backends.embedded import Embedded
from ..gaussians.language.encoders.calibration import Calibration, SizePrior
from ..gaussians.language.encoders.probability import distribution, labels, wholeness
from .augment import plain
from .renders import DAMAGED, NONE, WHOLE, Crops

Array = NDArray[np.float64]
ROOM = 14  # objects in a simulated room
MERGES = 4  # wrong segments (pieces and heaps) in addition
ROOMS = 400
REFUSED = 0.97  # least share of absent names that the threshold refuses; segmentation loses some more
WIDEN = 0.25  # added to the deviation of log sizes, since real objects vary more than our assets


def encode(encoder: Encoder, crops: Crops) -> NDArray[np.float32]:
    """`[M, V, D]` vectors of all crops over the neutral background."""
    import torch

    count, views = crops.pixels.shape[:2]
    rows = []
    for part in np.array_split(crops.pixels.reshape(-1, *crops.pixels.shape[2:]), max(1, count * views // 512)):
        pictures = (plain(torch.from_numpy(part), encoder.image_size) * 255 + 0.5).to(torch.uint8)
        rows.append(encoder.encode_images(pictures.permute(0, 2, 3, 1).contiguous().numpy()))
    return np.concatenate(rows).reshape(count, views, -1)


def size_priors(crops: Crops) -> dict[str, SizePrior]:
    """Mean and widened deviation of the log extents of each kind, from whole things."""
    priors = {}
    for kind in sorted(set(crops.labels[crops.states == WHOLE].tolist())):
        sizes = crops.sizes[(crops.labels == kind) & (crops.states == WHOLE)].astype(np.float64)
        level = np.sort(sizes[:, :2], axis=1)[:, ::-1]
        logs = np.log(np.maximum(np.concatenate([level, sizes[:, 2:]], axis=1), 1e-3))
        mean, std = logs.mean(axis=0), logs.std(axis=0) + WIDEN
        priors[kind] = SizePrior((mean[0], mean[1], mean[2]), (std[0], std[1], std[2]))
    return priors


def calibrate(
    encoder: Embedded, sets: Sequence[Crops], priors: dict[str, SizePrior], learnt_scale: float
) -> Calibration:
    """Fit scale and weight of sizes by the least log loss of the true labels, each thing counting the same. The
    threshold is the lowest that refuses `REFUSED` of the absent names in simulated rooms of each set: the sum of right
    answers and refusals hardly changes from 0.1 to 0.3, and finding a wrong thing does more harm than asking."""
    pooled = [encode(encoder, crops).mean(axis=1) for crops in sets]
    best: tuple[float, Calibration] | None = None
    for factor in (0.5, 0.7, 0.85, 1.0, 1.2, 1.5, 2.0):
        for weight in (0.0, 0.3, 0.6, 1.0, 1.4, 2.0):
            rule = Calibration(learnt_scale * factor, 0.5, weight, priors)
            tried = _with_calibration(encoder, rule)
            each = [_losses(tried, crops, vectors) for crops, vectors in zip(sets, pooled, strict=True)]
            loss = float(np.concatenate(each).mean())
            if best is None or loss < best[0]:
                best = (loss, rule)
    assert best is not None
    rule = best[1]
    tried, grid = _with_calibration(encoder, rule), np.linspace(0.05, 0.95, 91)
    enough = np.ones(len(grid), dtype=bool)
    for crops, vectors in zip(sets, pooled, strict=True):
        _, refused = _rooms(tried, crops, _table(tried, crops, vectors, sized=True), grid, seed=1)
        enough &= refused >= REFUSED
    return replace(rule, threshold=round(float(grid[enough.argmax() if enough.any() else -1]), 2))


def on_strangers(encoder: Embedded, crops: Crops) -> dict[str, float]:
    """Rates on held-out objects of other artists, by themselves and in simulated rooms of them."""
    pooled = encode(encoder, crops).mean(axis=1)
    result = {"things": float((crops.states == WHOLE).sum()), "unnamed": float((crops.states == NONE).sum())}
    for state in (WHOLE, DAMAGED):
        rows = crops.states == state
        result[f"top1_{state}"] = _top1(encoder, pooled[rows], crops.labels[rows])
        result[f"top1_size_{state}"] = _top1(encoder, pooled[rows], crops.labels[rows], crops.sizes[rows])
    grid = np.array([encoder.calibration.threshold])
    found, refused = _rooms(encoder, crops, _table(encoder, crops, pooled, sized=True), grid, seed=2)
    return result | {"present_right": float(found[0]), "absent_refused": float(refused[0])}


def figures(encoder: Embedded, crops: Crops) -> dict[str, float]:
    """All rates on a set that was used neither for training nor for calibration."""
    vectors = encode(encoder, crops)
    pooled = vectors.mean(axis=1)
    objects = crops.states != NONE
    result: dict[str, float] = {"things": float(len(crops)), "kinds": float(len(encoder.vocabulary.names))}
    for state in (WHOLE, DAMAGED):
        rows = crops.states == state
        single = [label for label, _ in labels(encoder, vectors[rows].reshape(-1, encoder.dim))]
        truth = np.repeat(crops.labels[rows], vectors.shape[1])
        result[f"top1_crop_{state}"] = float(np.mean(np.array(single) == truth))
        result[f"top1_mean_{state}"] = _top1(encoder, pooled[rows], crops.labels[rows])
        result[f"top1_mean_size_{state}"] = _top1(encoder, pooled[rows], crops.labels[rows], crops.sizes[rows])
    whole = wholeness(encoder, pooled)
    result["wholeness_auc"] = _auc(whole[objects], whole[~objects])
    result["whole_called_whole"] = float(np.mean(whole[objects] > 0.5))
    result["not_object_called_whole"] = float(np.mean(whole[~objects] > 0.5))
    for sized in (False, True):
        table = _table(encoder, crops, pooled, sized)
        grid = np.array([encoder.calibration.threshold])
        found, refused = _rooms(encoder, crops, table, grid, seed=2)
        suffix = "_with_sizes" if sized else ""
        truth_table = crops.labels[:, None] == np.array(encoder.vocabulary.names)
        over = table >= encoder.calibration.threshold
        result[f"miss{suffix}"] = float(np.mean(~over[truth_table]))
        result[f"false_alarm_per_thing{suffix}"] = float(np.mean(over[~truth_table]))
        result[f"room_present_right{suffix}"] = float(found[0])
        result[f"room_absent_refused{suffix}"] = float(refused[0])
    return result


def confusions(encoder: Encoder, crops: Crops) -> dict[str, dict[str, float]]:
    """For each kind that the crops show: top-1 of the mean vector over whole and damaged things, and its three most
    frequent mistakes."""
    pooled = encode(encoder, crops).mean(axis=1)
    guess = np.array([label for label, _ in labels(encoder, pooled)])
    table = {}
    for kind in encoder.vocabulary.names:
        rows = crops.labels == kind
        if not rows.any():
            continue
        wrong = Counter(g for g in guess[rows].tolist() if g != kind).most_common(3)
        table[kind] = {"right": round(float(np.mean(guess[rows] == kind)), 3)} | {
            g: round(c / max(1, int(rows.sum())), 3) for g, c in wrong
        }
    return table


def milliseconds(encoder: Encoder, count: int = 64) -> tuple[float, float]:
    """Milliseconds for one image in a batch of 16 and for one phrase, each the best of several runs."""
    pictures = (
        np.random.default_rng(0).integers(0, 255, (16, encoder.image_size, encoder.image_size, 3)).astype(np.uint8)
    )
    image, text = [], []
    for _ in range(count // 16 + 3):
        start = time.perf_counter()
        encoder.encode_images(pictures)
        middle = time.perf_counter()
        encoder.encode_text(["small red wooden chair"])
        image.append((middle - start) / 16)
        text.append(time.perf_counter() - middle)
    return 1e3 * min(image), 1e3 * min(text)


def _with_calibration(encoder: Embedded, rule: Calibration) -> Embedded:
    """The same encoder with another calibration; it shares the sessions."""
    other = Embedded(encoder.folder)
    vars(other).update({k: v for k, v in vars(encoder).items() if k != "calibration"})
    vars(other)["calibration"] = rule
    return other


def _top1(
    encoder: Encoder, pooled: NDArray[np.float32], truth: NDArray[np.str_], sizes: NDArray[np.float32] | None = None
) -> float:
    return float(np.mean(np.array([label for label, _ in labels(encoder, pooled, sizes)]) == truth))


def _losses(encoder: Encoder, crops: Crops, pooled: NDArray[np.float32]) -> Array:
    """Negative log probability of the true name of each whole or damaged thing, and of being no object of each other;
    objects without a name are left out."""
    names = (*encoder.vocabulary.names, *encoder.vocabulary.negatives)
    rows = np.isin(crops.labels, names)
    share = distribution(encoder, pooled, crops.sizes)[rows]
    share[:, len(encoder.vocabulary.names) :] = share[:, len(encoder.vocabulary.names) :].sum(axis=1, keepdims=True)
    column = [names.index(k) for k in crops.labels[rows].tolist()]
    return np.asarray(-np.log(np.maximum(share[np.arange(len(share)), column], 1e-4)))


def _table(encoder: Encoder, crops: Crops, pooled: NDArray[np.float32], sized: bool) -> Array:
    """`[M, K]` probability that each thing is each kind: the result of `probability` for all canonical names."""
    return distribution(encoder, pooled, crops.sizes if sized else None)[:, : len(encoder.vocabulary.names)]


def _rooms(encoder: Encoder, crops: Crops, table: Array, grid: Array, seed: int) -> tuple[Array, Array]:
    """Query simulated rooms, objects of different kinds and some wrong segments, at each threshold of `grid` `[T]`.

    Returns:
        Share of present kinds for which the best thing over the threshold is the right one, and share of absent kinds
        for which nothing is over it; `[T]` each.
    """
    rng = np.random.default_rng(seed)
    names = np.array(encoder.vocabulary.names)
    objects, others = np.flatnonzero(crops.states != NONE), np.flatnonzero(crops.states == NONE)
    shown = np.flatnonzero(np.isin(names, crops.labels[objects]))
    found: list[NDArray[np.bool_]] = []
    refused: list[NDArray[np.bool_]] = []
    for _ in range(ROOMS):
        kinds = rng.choice(shown, size=min(ROOM, len(shown)), replace=False)
        inside = [int(rng.choice(objects[crops.labels[objects] == names[k]])) for k in kinds]
        scores = table[[*inside, *rng.choice(others, size=MERGES)]]  # [things, K]
        best = scores.argmax(axis=0)
        for place, k in enumerate(kinds):
            found.append((best[k] == place) & (scores[best[k], k] >= grid))
        absent = np.setdiff1d(np.arange(len(names)), kinds)
        refused.extend(scores[:, k].max() < grid for k in rng.choice(absent, size=min(4, len(absent)), replace=False))
    return np.mean(found, axis=0), np.mean(refused, axis=0)


def _auc(positive: Array, negative: Array) -> float:
    """Area under the ROC curve: probability that a random positive scores above a random negative."""
    order = np.concatenate([positive, negative]).argsort().argsort() + 1.0
    rank = order[: len(positive)].sum() - len(positive) * (len(positive) + 1) / 2
    return float(rank / (len(positive) * len(negative)))
