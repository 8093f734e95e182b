"""Selection in a real room: a trained scene, a detector's coarse masks, real CLIP vectors and four annotated photos.

The selected Gaussians are rendered white and the others black from the camera of a photo, and this silhouette is
compared with the annotation; pixels without annotation do not count. The data may be used for measuring but not be
redistributed, so no picture of it is kept.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import fmean

import numpy as np
import torch
from numpy.typing import NDArray

from ..gaussians.camera import Camera
from ..gaussians.files import load
from ..gaussians.files.captures.capture import read_capture
from ..gaussians.harmonics import color_to_dc
from ..gaussians.language import masks
from ..gaussians.language.encoders import Encoder
from ..gaussians.language.encoders.backends.vectors import wrap
from ..gaussians.language.field.embed import embed
from ..gaussians.language.query.query import Query
from ..gaussians.language.query.resolve import resolve
from ..gaussians.render import render
from ..gaussians.scene import Scene
from .harness import Metric

UNLABELED = 255  # pixel value without annotation
MIN_PIXELS = 200  # pixels of a thing from which a photo counts as showing it
# The 80 classes of COCO (Lin et al. 2014) in their order, which is that of `coco_clip_a+cname.npy`.
COCO = (
    "person", "bicycle", "car", "motorcycle", "airplane", "bus", "train", "truck", "boat", "traffic light",
    "fire hydrant", "stop sign", "parking meter", "bench", "bird", "cat", "dog", "horse", "sheep", "cow", "elephant",
    "bear", "zebra", "giraffe", "backpack", "umbrella", "handbag", "tie", "suitcase", "frisbee", "skis", "snowboard",
    "sports ball", "kite", "baseball bat", "baseball glove", "skateboard", "surfboard", "tennis racket", "bottle",
    "wine glass", "cup", "fork", "knife", "spoon", "bowl", "banana", "apple", "sandwich", "orange", "broccoli",
    "carrot", "hot dog", "pizza", "donut", "cake", "chair", "couch", "potted plant", "bed", "dining table", "toilet",
    "tv", "laptop", "mouse", "remote", "keyboard", "cell phone", "microwave", "oven", "toaster", "sink",
    "refrigerator", "book", "clock", "vase", "scissors", "teddy bear", "hair drier", "toothbrush",
)  # fmt: skip
# Each query, and the annotated labels that it means. The detector's masks of a potted plant cover its crown and a tenth
# of the pot; the figure with the pot is reported separately and is not part of the mean.
QUERIES: dict[str, tuple[Query, tuple[int, ...]]] = {
    "bicycle": (Query(text="bicycle"), (5,)),
    "chair": (Query(text="chair", pick="all"), (7, 8)),
    "potted plant": (Query(text="potted plant"), (1,)),
    "purple cloth": (Query(text="cloth", colors=("purple",)), (4,)),
    "pink tree": (Query(text="tree", colors=("pink",)), (1,)),
    "red bicycle": (Query(text="bicycle", colors=("red",)), (5,)),
}
WITH_POT = (Query(text="potted plant"), (1, 2))
SPURIOUS = ("cat", "person", "couch")  # false detections: none of these is in the room


@dataclass(frozen=True, eq=False)
class Drawing:
    """One annotated photo: its camera, and the label of each pixel `[H, W]`."""

    camera: Camera
    labels: NDArray[np.uint8]


def drawings(capture: Path) -> list[Drawing]:
    """The ground truth of a capture."""
    from PIL import Image

    by_name = {Path(camera.name).stem: camera for camera in read_capture(capture).cameras}
    found = []
    for path in sorted((capture / "ground_truth").glob("*.png")):
        labels = np.array(Image.open(path))
        found.append(Drawing(by_name[path.stem].resized(labels.shape[1], labels.shape[0]), labels))
    return found


def silhouette(scene: Scene, chosen: NDArray[np.bool_], camera: Camera) -> NDArray[np.bool_]:
    """`[H, W]`: pixels mostly covered by the chosen Gaussians `[N]`, with occlusion by the whole scene."""
    white = torch.from_numpy(chosen)[:, None].expand(-1, 3).float()
    cloud = scene.cloud.with_degree(0).replace(sh=color_to_dc(white)[:, None].contiguous())
    seen: NDArray[np.bool_] = (render(cloud, camera).rgb[..., 0] > 0.5).numpy()
    return seen


def agreement(found: NDArray[np.bool_], drawing: Drawing, labels: Sequence[int]) -> float | None:
    """Intersection over union of a silhouette and the annotated labels; None if the photo does not show them."""
    true, counted = np.isin(drawing.labels, labels), drawing.labels != UNLABELED
    if true.sum() < MIN_PIXELS:
        return None
    shown = found & counted
    return float((shown & true).sum() / (shown | true).sum())


def figures(data: Path) -> list[Metric]:
    """Every figure of the real room."""
    capture = data / "captures" / "bonsai_room"
    encoder = wrap([(name,) for name in COCO], np.load(data / "clip_vectors" / "coco_clip_a+cname.npy"))
    bare = replace(load(data / "scenes" / "bonsai_room.ply"), cameras=read_capture(capture).cameras)
    start = time.perf_counter()
    scene = embed(bare, encoder, masks=masks.load(f"folder:{capture / 'masks'}", capture / "transforms.json"))
    seconds = time.perf_counter() - start
    drawn = drawings(capture)
    scores = {name: _score(scene, encoder, drawn, *query) for name, query in QUERIES.items()}
    refused = [resolve(scene, Query(text=name), drawn[0].camera, encoder).verdict == "absent" for name in SPURIOUS]
    return [
        Metric("bonsai.mean_iou", fmean(scores.values()), "IoU", "higher", 0.03, 0.80),
        *(Metric(f"bonsai.{name.replace(' ', '_')}", value, "IoU", "higher", 0.05) for name, value in scores.items()),
        Metric("bonsai.potted_plant_with_pot", _score(scene, encoder, drawn, *WITH_POT), "IoU", "higher", 0.05),
        Metric("bonsai.spurious.refused", fmean(refused), "share", "higher", 0.1),
        Metric("bonsai.embed.seconds", seconds, "s", "lower", 0.3),
    ]


def _score(scene: Scene, encoder: Encoder, drawn: Sequence[Drawing], query: Query, labels: tuple[int, ...]) -> float:
    """Mean agreement over the photos that show the labels; the query is resolved from the camera of the first photo."""
    chosen = resolve(scene, query, drawn[0].camera, encoder).mask(scene.cloud).numpy()
    each = [agreement(silhouette(scene, chosen, d.camera), d, labels) for d in drawn]
    return fmean(value for value in each if value is not None)
