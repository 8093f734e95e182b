"""A real room through a small detector's eyes: what its masks and real CLIP vectors of their labels make of it.

Floors are what was measured, less a margin for other machines; they are not goals reached.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from PIL import Image

from scenewright.benchmarks._select.association import Tracks, associate
from scenewright.gaussians.files import load
from scenewright.gaussians.files.captures.capture import Capture, read_capture
from scenewright.gaussians.harmonics import color_to_dc
from scenewright.gaussians.language import masks
from scenewright.gaussians.language.encoders.backends.vectors import Vectors, wrap
from scenewright.gaussians.language.field.embed import embed
from scenewright.gaussians.language.masks.lifting import lift
from scenewright.gaussians.language.query.query import Query
from scenewright.gaussians.language.query.resolve import resolve
from scenewright.gaussians.render import render
from scenewright.gaussians.scene import Scene

pytestmark = pytest.mark.slow

# Rows of `coco_clip_a+cname.npy` that the detector's labels are among: the 80 classes of COCO in their usual order.
NAMES = {
    "person": 0, "bicycle": 1, "cat": 15, "dog": 16, "backpack": 24, "handbag": 26, "suitcase": 28, "bowl": 45,
    "chair": 56, "couch": 57, "potted plant": 58, "bed": 59, "dining table": 60, "tv": 62, "laptop": 63,
    "refrigerator": 72, "book": 73, "clock": 74, "vase": 75,
}  # fmt: skip


@pytest.fixture(scope="module")
def capture(data_dir: Path) -> Capture:
    if not (data_dir / "captures/bonsai_room/transforms.json").exists():
        pytest.skip("the capture of the bonsai room is not among the real data")
    return read_capture(data_dir / "captures/bonsai_room")


@pytest.fixture(scope="module")
def encoder(data_dir: Path) -> Vectors:
    rows = np.load(data_dir / "clip_vectors/coco_clip_a+cname.npy")[list(NAMES.values())]
    return wrap([[name] for name in NAMES], rows)


@pytest.fixture(scope="module")
def bare(data_dir: Path, capture: Capture) -> Scene:
    return load(data_dir / "scenes/bonsai_room.ply").replace(cameras=capture.cameras)


@pytest.fixture(scope="module")
def room(bare: Scene, encoder: Vectors, capture: Capture) -> Scene:
    return embed(bare, encoder, masks=masks.load(f"folder:{capture.path.parent / 'masks'}"))


@pytest.fixture(scope="module")
def tracks(bare: Scene, capture: Capture) -> Tracks:
    return associate(lift(bare.cloud, masks.load(f"folder:{capture.path.parent / 'masks'}").masks(bare)))


def test_objects_are_labelled_and_masks_of_too_few_views_are_discarded(tracks: Tracks) -> None:
    names = [t.label for t in tracks.tracks if t.label]
    assert {"bicycle", "chair", "potted plant"} <= set(names) and names.count("chair") == 2  # both are real
    assert not {"cat", "person", "couch", "dining table", "vase", "bed"} & set(names)
    heard = {name for t in tracks.tracks for name, _ in t.votes}
    assert {"cat", "person", "couch"} <= heard  # the detector did say so


def test_the_cloth_that_is_called_chair_now_and_then_is_no_chair(room: Scene, tracks: Tracks) -> None:
    cloth = max((t for t in tracks.tracks if not t.label), key=lambda t: len(t.masks))
    assert cloth.votes[0][0] == "chair" and cloth.views > 40
    assert room.language is not None
    assert all(g.label_score < 0.5 for g in room.language.objects() if 20_000 < g.count < 25_000)


def silhouette(scene: Scene, rows: torch.Tensor, camera: Any) -> np.ndarray[Any, Any]:
    """Where the selected Gaussians make up most of a pixel, hidden by the others as in the scene."""
    white = rows[:, None].expand(-1, 3).float()
    flat = scene.cloud.with_degree(0).replace(sh=color_to_dc(white)[:, None].contiguous())
    shown: np.ndarray[Any, Any] = render(flat, camera).rgb[..., 0].numpy() > 0.5
    return shown


@pytest.mark.parametrize(
    ("asked", "drawn", "floor"),
    [  # measured: 0.764, 0.621, 0.767, 0.944, 0.734, 0.764
        ({"text": "bicycle"}, (5,), 0.72),
        ({"text": "chair", "pick": "all"}, (7, 8), 0.57),
        ({"text": "potted plant"}, (1,), 0.72),
        ({"text": "cloth", "colors": ("purple",)}, (4,), 0.90),
        ({"text": "tree", "colors": ("pink",)}, (1,), 0.69),
        ({"text": "bicycle", "colors": ("red",)}, (5,), 0.72),
    ],
    ids=["bicycle", "chair", "potted plant", "purple cloth", "pink tree", "red bicycle"],
)
def test_words_find_what_was_drawn_by_hand(
    room: Scene, encoder: Vectors, capture: Capture, asked: dict[str, Any], drawn: tuple[int, ...], floor: float
) -> None:
    found = resolve(room, Query(**asked), capture.cameras[0], encoder)
    # No source knows "cloth" or "tree" here: what is chosen by its colour alone waits for a yes.
    assert found.verdict == ("found" if asked["text"] in NAMES else "unconfirmed")
    scores = []
    for path in sorted((capture.path.parent / "ground_truth").glob("*.png")):
        labels, camera = np.array(Image.open(path)), capture.camera(path.stem)
        true, counted = np.isin(labels, drawn), labels != 255
        if camera is not None and true.sum() > 200:
            seen = silhouette(room, found.mask(room.cloud), camera) & counted
            scores.append((seen & true).sum() / (seen | true).sum())
    assert len(scores) >= 2 and np.mean(scores) > floor


@pytest.mark.parametrize("word", ["cat", "person", "dog", "refrigerator", "suitcase"])
def test_what_is_not_in_the_room_is_absent(room: Scene, encoder: Vectors, capture: Capture, word: str) -> None:
    assert resolve(room, Query(text=word), capture.cameras[0], encoder).verdict == "absent"


@pytest.mark.parametrize("kept", [0.5, 0.2])
def test_fewer_photographs_find_the_same_things(bare: Scene, capture: Capture, kept: float) -> None:
    views = list(masks.load(f"folder:{capture.path.parent / 'masks'}").masks(bare))
    some = np.sort(np.random.default_rng(0).permutation(len(views))[: round(kept * len(views))])
    names = {t.label for t in associate(lift(bare.cloud, [views[i] for i in some])).tracks}
    assert {"bicycle", "chair", "potted plant"} <= names and not {"cat", "person", "couch"} & names
