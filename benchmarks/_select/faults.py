"""True masks and masks with simulated faults, as curves: what the default embedding makes of them.

The masks are those of the true objects in 24 pictures of 512 pixels a side. Each fault is drawn anew for each picture,
except that of layers, whose levels are the same in all pictures as those of a segmenter of everything are.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from statistics import fmean

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from ...gaussians.language.encoders import Encoder
from ...gaussians.language.masks import NONE, ViewMasks
from .._iou import iou
from ..harness import Metric
from . import pictures
from .cases import Case, Part
from .lifted import VIEWS, guiding
from .stability import names_miou

I32 = NDArray[np.int32]
Rng = np.random.Generator
Fault = Callable[[ViewMasks, Rng], ViewMasks]

SIZE = 512  # pixels a side
WAVE = 0.03  # of a picture's side, over which displaced borders wander
REACH = 3  # pixels between masks that touch
LEAST = 60  # pixels of a mask that is kept


def border(pixels: float) -> Fault:
    """Borders displaced smoothly, by `pixels` in the root mean square."""

    def spoil(view: ViewMasks, rng: Rng) -> ViewMasks:
        side = max(view.ids.shape)
        drift = ndimage.gaussian_filter(rng.standard_normal((2, *view.ids.shape)), (0, WAVE * side, WAVE * side))
        drift *= pixels / max(float(np.sqrt((drift**2).sum(axis=0).mean())), 1e-12)
        moved = ndimage.map_coordinates(view.ids, np.indices(view.ids.shape) + drift, order=0, mode="nearest")
        return replace(view, ids=moved)

    return spoil


def split(share: float) -> Fault:
    """A share of the masks cut in two along a random line through their middle."""

    def spoil(view: ViewMasks, rng: Rng) -> ViewMasks:
        ids, labels, scores = view.ids.copy(), list(view.labels), view.scores.tolist()
        for m in np.flatnonzero(rng.random(len(view)) < share).tolist():
            y, x = np.nonzero(view.ids == m)
            angle = rng.uniform(0, np.pi)
            side = (x - np.median(x)) * np.cos(angle) + (y - np.median(y)) * np.sin(angle) > 0
            if LEAST < side.sum() < len(side) - LEAST:
                ids[y[side], x[side]] = len(labels)
                labels.append(view.labels[m])
                scores.append(float(view.scores[m]))
        return replace(view, ids=ids, labels=tuple(labels), scores=np.array(scores, np.float32))

    return spoil


def merged(share: float) -> Fault:
    """A share of the masks joined with one that they touch."""

    def spoil(view: ViewMasks, rng: Rng) -> ViewMasks:
        ids = view.ids.copy()
        for m in np.flatnonzero(rng.random(len(view)) < share).tolist():
            around = ndimage.binary_dilation(ids == m, iterations=REACH)
            near = np.unique(ids[around & (ids != m)])
            near = near[near >= 0]
            if len(near):
                ids[ids == m] = int(rng.choice(near))
        return replace(view, ids=ids)

    return spoil


def missed(share: float) -> Fault:
    """A share of the masks left out."""

    def spoil(view: ViewMasks, rng: Rng) -> ViewMasks:
        gone = np.flatnonzero(rng.random(len(view)) < share)
        return replace(view, ids=np.where(np.isin(view.ids, gone), NONE, view.ids))

    return spoil


def mislabelled(share: float, names: Sequence[str]) -> Fault:
    """A share of the labels replaced by any other of `names`; masks of objects must have labels."""

    def spoil(view: ViewMasks, rng: Rng) -> ViewMasks:
        wrong = rng.random(len(view)) < share
        other = rng.choice(np.array(names), len(view))
        labels = (str(o) if w else label for label, o, w in zip(view.labels, other, wrong, strict=True))
        return replace(view, labels=tuple(labels))

    return spoil


def layered(view: ViewMasks, rng: Rng) -> ViewMasks:
    """Regions of all pixels in layers, as a hierarchy of contours gives them: pieces of the masks and of what they
    leave, then the masks, then masks joined with those that they touch, then nearly everything."""
    height, width = view.ids.shape
    fine = _pieces(view.ids, rng, 40)
    whole = np.where(view.ids >= 0, view.ids, len(view))
    joined = merged(0.5)(replace(view, ids=view.ids), rng).ids
    coarse = np.where(joined >= 0, joined, len(view))
    layers, count = [], 0
    for layer in (fine, whole, coarse, np.zeros((height, width), np.int32)):
        names, place = np.unique(layer, return_inverse=True)
        layers.append((place.reshape(height, width) + count).astype(np.int32))
        count += len(names)
    return replace(view, ids=np.stack(layers), labels=("",) * count, scores=np.full(count, 0.5, np.float32))


def _pieces(ids: I32, rng: Rng, count: int) -> NDArray[np.int64]:
    """A map in which each mask falls into cells around random points."""
    height, width = ids.shape
    seeds = np.full((height, width), True)
    seeds[rng.integers(0, height, count), rng.integers(0, width, count)] = False
    nearest = ndimage.distance_transform_edt(seeds, return_distances=False, return_indices=True)
    cell = nearest[0].astype(np.int64) * width + nearest[1]
    return np.unique(cell * (int(ids.max()) + 2) + ids + 1, return_inverse=True)[1].reshape(height, width)


def with_names(case: Case, views: Sequence[ViewMasks], of: Sequence[Sequence[int]]) -> list[ViewMasks]:
    """The views with the kinds of the objects as labels of their masks."""
    kinds = [o.kind for o in case.objects]
    return [replace(v, labels=tuple(kinds[i] for i in own)) for v, own in zip(views, of, strict=True)]


def faults() -> dict[str, Fault | None]:
    """All faults by name; None for masks without any."""
    return {
        "none": None,
        **{f"border_{pixels}px": border(pixels) for pixels in (2, 4, 8)},
        "split_50%": split(0.5),
        "merged_30%": merged(0.3),
        "missed_30%": missed(0.3),
        "layers": layered,
    }


def measure(rooms: Sequence[Case], known: Sequence[Case], encoder: Encoder) -> Part:
    """mIoU of names and of the best group of each object, for each fault.

    Args:
        known: the same rooms embedded without masks.
    """
    drawn = []
    for room in rooms:
        eyes = pictures.eyes(room.scene, VIEWS, SIZE)
        drawn.append([pictures.true_masks(room, eye, pictures.nothing_said, i) for i, eye in enumerate(eyes)])
    metrics = _figures("geometry_alone", known, encoder)
    settings = {**faults(), "mislabelled_20%": mislabelled(0.2, encoder.vocabulary.names), "views_dropped_50%": None}
    for name, fault in settings.items():
        cases = []
        for room, seen in zip(rooms, drawn, strict=True):
            views = [s.masks for s in seen]
            if name.startswith("mislabelled"):
                views = with_names(room, views, [s.objects for s in seen])
            if name.startswith("views_dropped"):
                views = [views[i] for i in np.random.default_rng(room.seed).permutation(VIEWS)[: VIEWS // 2]]
            if fault is not None:
                views = [fault(v, np.random.default_rng([room.seed, i])) for i, v in enumerate(views)]
            cases.append(replace(room, scene=guiding(room, views, encoder)))
        metrics += _figures(name, cases, encoder)
    note = (
        f"masks: true masks of {VIEWS} pictures of {SIZE} x {SIZE} guide the default embedding, with noise of "
        f"{pictures.SHAKE:.1%} of the picture on their outlines, and with one fault each; oracle: the best group"
    )
    return Part(tuple(metrics), notes=(note,))


def _figures(name: str, cases: Sequence[Case], encoder: Encoder) -> list[Metric]:
    named = fmean(v for case in cases for v in names_miou(case, encoder))
    best = fmean(max(iou(mask, case.truth(o)) for mask in case.groups()) for case in cases for o in case.objects)
    goal = 0.95 if name == "none" else None
    return [
        Metric(f"masks.{name}.miou", named, "IoU", "higher", 0.03, goal),
        Metric(f"masks.{name}.oracle", best, "IoU", "higher", 0.03),
    ]
