"""Measure contour maps against true instance masks: precision and recall of thinned borders within a tolerance."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from PIL import Image
from scipy.ndimage import distance_transform_edt, gaussian_filter, map_coordinates

from ...gaussians.color import rgb_to_lab
from .augment import borders, whole
from .dataset import Pictures
from .model import CHANNELS, STRIDE

F32 = NDArray[np.float32]
Detector = Callable[[F32], F32]  # channels [8, H, W] of any size to contour strengths [H, W]
THRESHOLDS = np.linspace(0.05, 0.95, 19)
FIXED = 0.5  # the threshold of the figures at a fixed threshold
LONGEST = 400  # pixels of the longer side of photographs
IGNORE = 255
EDGE = 3  # pixels beside the rim of the picture that are not judged


@dataclass(frozen=True, eq=False)
class Case:
    """A picture `[8, H, W]`, its true border lines `[H, W]`, and where predictions are judged `[H, W]`."""

    channels: F32
    line: NDArray[np.bool_]
    judged: NDArray[np.bool_]


def onnx_detector(path: Path) -> Detector:
    """The exported network on one thread; sides are padded by reflection."""
    import onnxruntime

    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    session = onnxruntime.InferenceSession(str(path), options, providers=["CPUExecutionProvider"])

    def run(channels: F32) -> F32:
        height, width = channels.shape[1:]
        pad = ((0, 0), (0, -height % STRIDE), (0, -width % STRIDE))
        (out,) = session.run(None, {"picture": np.pad(channels, pad, mode="reflect")[None]})
        strength: F32 = out[0, 0, :height, :width]
        return strength

    return run


def color_gradient(channels: F32) -> F32:
    """The classical baseline: magnitude of the Lab gradient at a scale of 1.5 pixels, 1 at 15 units a pixel."""
    lab = rgb_to_lab(torch.from_numpy(channels[:3].transpose(1, 2, 0).copy())).numpy()
    squares = [gaussian_filter(lab[..., k], 1.5, order=o) ** 2 for k in range(3) for o in ((0, 1), (1, 0))]
    strength: F32 = np.clip(np.sqrt(sum(squares)) / 15, 0, 1).astype(np.float32)
    return strength


def thinned(strength: F32) -> F32:
    """Keep ridges one pixel wide: a value stays where it is the largest across its ridge, else 0."""
    soft = gaussian_filter(strength, 1.0)
    gy, gx = np.gradient(soft)
    (hyy, hyx), (_, hxx) = np.gradient(gy), np.gradient(gx)
    angle = 0.5 * np.arctan2(2 * hyx, hxx - hyy)  # axis of the largest curvature in magnitude, or the one across it
    curve = [
        hxx * np.cos(a) ** 2 + 2 * hyx * np.cos(a) * np.sin(a) + hyy * np.sin(a) ** 2
        for a in (angle, angle + np.pi / 2)
    ]
    across = np.where(curve[0] < curve[1], angle, angle + np.pi / 2)
    rows, cols = np.indices(strength.shape)
    keep = np.ones(strength.shape, bool)
    for sign in (1, -1):
        at = [rows + sign * np.sin(across), cols + sign * np.cos(across)]
        keep &= soft >= map_coordinates(soft, at, order=1, mode="nearest")
    return np.where(keep, strength, 0).astype(np.float32)


def lines(things: NDArray[np.integer]) -> NDArray[np.bool_]:
    """Border lines `[H, W]` one pixel wide: pixels that differ from the right or the lower neighbour."""
    result = np.zeros(things.shape, bool)
    result[:, :-1] |= things[:, 1:] != things[:, :-1]
    result[:-1] |= things[1:] != things[:-1]
    return result


def figures(cases: Iterable[Case], detect: Detector, tolerance: float) -> dict[str, float]:
    """Best F over one threshold for all pictures (ODS), that threshold, average precision, and precision and recall at
    the fixed and the best threshold. Matches are within `tolerance` pixels."""
    hits = np.zeros((len(THRESHOLDS), 4))  # predicted, of them right, true, of them found
    for case in cases:
        strength = thinned(detect(case.channels)) * case.judged
        near = distance_transform_edt(~case.line) <= tolerance
        for i, threshold in enumerate(THRESHOLDS):
            marked = strength >= threshold
            found = distance_transform_edt(~marked) <= tolerance if marked.any() else np.zeros_like(marked)
            truth = case.line & case.judged
            hits[i] += (marked.sum(), (marked & near).sum(), truth.sum(), (truth & found).sum())
    precision, recall = hits[:, 1] / np.maximum(hits[:, 0], 1), hits[:, 3] / np.maximum(hits[:, 2], 1)
    f = 2 * precision * recall / np.maximum(precision + recall, 1e-9)
    best, fixed = int(f.argmax()), int(np.abs(THRESHOLDS - FIXED).argmin())
    order = np.argsort(recall)
    even = np.linspace(0, 1, 101)
    envelope = np.maximum.accumulate(np.interp(even, recall[order], precision[order], right=0)[::-1])[::-1]
    result = {
        "f_best": f[best], "threshold_best": THRESHOLDS[best], "average_precision": envelope.mean(),
        "precision_best": precision[best], "recall_best": recall[best],
        "f_fixed": f[fixed], "precision_fixed": precision[fixed], "recall_fixed": recall[fixed],
    }  # fmt: skip
    return {k: round(float(v), 4) for k, v in result.items()}


def held_out(data: Pictures, depth: bool) -> list[Case]:
    """Rendered pictures with and without depth; borders between two walls are not judged."""
    cases = []
    for i in range(len(data)):
        shown = whole(data, i, depth)
        line = lines(data.things[i]) & (shown.border == 1)
        cases.append(Case(shown.channels, line, _inner(line.shape) & (shown.border != 2)))
    return cases


def photographs(pairs: Sequence[tuple[Path, Path]], ignore: int = IGNORE) -> list[Case]:
    """Photographs with label images. Predictions are judged on labelled things and a rim of 8 pixels round them:
    what else the picture shows has borders too, that nobody drew."""
    cases = []
    for photograph, labels in pairs:
        image = Image.open(photograph).convert("RGB")
        scale = LONGEST / max(image.size)
        size = (round(image.width * scale), round(image.height * scale))
        rgb = np.asarray(image.resize(size, Image.Resampling.BOX), np.float32) / 255
        things = np.asarray(Image.open(labels).resize(size, Image.Resampling.NEAREST))
        unknown = distance_transform_edt(things != ignore) <= 2 if ignore >= 0 else np.zeros(things.shape, bool)
        line = (borders(things.astype(np.int32) + 10) == 1) & lines(things) & ~unknown
        near = distance_transform_edt((things == 0) | (things == ignore)) <= 8
        channels = np.concatenate([rgb.transpose(2, 0, 1), np.zeros((CHANNELS - 3, *things.shape), np.float32)])
        cases.append(Case(channels, line, near & ~unknown & _inner(line.shape)))
    return cases


def captures(folder: Path) -> dict[str, list[Case]]:
    """The captures with true masks in a folder of captures; those that are missing are left out."""
    found: dict[str, list[Case]] = {}
    diorama, bonsai = folder / "diorama_table", folder / "bonsai_room"
    if (diorama / "instances").is_dir():
        masks = sorted((diorama / "instances").glob("*.png"))[::10]
        found["diorama_table"] = photographs([(diorama / "images" / f"{m.stem}.jpg", m) for m in masks], ignore=-1)
    if (bonsai / "ground_truth").is_dir():
        masks = sorted((bonsai / "ground_truth").glob("*.png"))
        images = [next((bonsai / "images").glob(f"{m.stem}.*")) for m in masks]
        found["bonsai_room"] = photographs(list(zip(images, masks, strict=True)))
    return found


def _inner(shape: tuple[int, ...]) -> NDArray[np.bool_]:
    inside = np.zeros(shape, bool)
    inside[EDGE:-EDGE, EDGE:-EDGE] = True
    return inside


def report(network: Path, data: Pictures, folder: Path | None) -> dict[str, Any]:
    """All figures of a network beside those of the baseline."""
    detectors = {"network": onnx_detector(network), "color_gradient": color_gradient}
    sets: dict[str, tuple[list[Case], float]] = {
        "held_out": (held_out(data, depth=False), 2.0),
        "held_out_with_depth": (held_out(data, depth=True), 2.0),
    }
    for name, cases in (captures(folder) if folder is not None else {}).items():
        sets[name] = (cases, 4.0)
    return {
        name: {"tolerance_px": tolerance, "pictures": len(cases)}
        | {kind: figures(cases, detect, tolerance) for kind, detect in detectors.items()}
        for name, (cases, tolerance) in sets.items()
    }


def shown(figures_: dict[str, Any]) -> str:
    """Figures as JSON for people."""
    return json.dumps(figures_, indent=1)
