"""What each capture is measured with: its drawn truth, the sources of masks of each setting, and the embedded scene."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from ....gaussians.files import load
from ....gaussians.files.captures.capture import read_capture
from ....gaussians.language import encoders, masks
from ....gaussians.language.encoders import Encoder
from ....gaussians.language.encoders.backends.vectors import wrap
from ....gaussians.language.field.embed import embed
from ....gaussians.language.masks import Masker, ViewMasks
from ....gaussians.scene import Scene
from .coco import COCO
from .drawings import BACKGROUND, IGNORE, UNLABELED, Drawing, cameras, outlined, painted
from .fitted import scene_of

HERE = Path(__file__).parent
SHOWN = ("005", "022", "041", "058", "077", "094")  # photographs of `diorama_table` that are judged by
EVERY = 4  # of its photographs the first of so many carries the true masks that are given


@dataclass(frozen=True, eq=False)
class Truth:
    """A capture with what is drawn on its photographs and said of them.

    Attributes:
        capture: its folder.
        public, other: annotated photographs; the other ones were drawn on later, by somebody else.
        numbers: label of each drawn thing.
        said: the capture's entry of `said.json`.
    """

    capture: Path
    public: tuple[Drawing, ...]
    other: tuple[Drawing, ...]
    numbers: dict[str, int]
    said: dict[str, Any]

    @property
    def drawn(self) -> tuple[Drawing, ...]:
        """All annotated photographs, the public ones first."""
        return (*self.public, *self.other)

    def labels(self, names: Sequence[str]) -> tuple[int, ...]:
        """The labels of drawn things."""
        return tuple(self.numbers[name] for name in names)


@dataclass(frozen=True)
class Setting:
    """What an embedding is given: `name` is part of the figures' keys.

    Attributes:
        masks: "folder" (a detector's), "true", or "".
        photographs: whether the capture's photographs are a source of masks.
        coco: whether vectors of a real encoder for the detector's names replace the default encoder.
        bare: whether the scene comes without the capture's cameras.
    """

    name: str
    masks: str = ""
    photographs: bool = False
    coco: bool = False
    bare: bool = False


SETTINGS: dict[str, tuple[Setting, ...]] = {
    "bonsai_room": (
        Setting("masks_coco", masks="folder", photographs=True, coco=True),
        Setting("masks", masks="folder", photographs=True),
        Setting("photos", photographs=True),
        Setting("bare", bare=True),
    ),
    "diorama_table": (Setting("true_masks", masks="true"), Setting("photos", photographs=True), Setting("bare")),
    "desk_laptop": (Setting("photos", photographs=True), Setting("bare")),
    "bench_box": (Setting("photos", photographs=True), Setting("bare")),
}


@dataclass(frozen=True, eq=False)
class Given:
    """Masks that are there already, as a source of masks."""

    views: tuple[ViewMasks, ...]

    def masks(
        self, scene: Scene, progress: Callable[[str, float], None] = lambda stage, share: None
    ) -> Iterator[ViewMasks]:
        """See `Masker`."""
        yield from self.views


def truth_of(captures: Path, name: str) -> Truth:
    """The drawn truth of a capture."""
    capture = captures / name
    said = json.loads((HERE / "said.json").read_text(encoding="utf-8"))[name]
    outlines = HERE / "drawn" / f"{name}.json"
    if "labels" in said:
        numbers = dict(said["labels"])
    else:
        photos = json.loads(outlines.read_text(encoding="utf-8"))
        names = dict.fromkeys(thing for photo in photos.values() for thing, _ in photo["regions"])
        drawn_names = [n for n in names if n not in (IGNORE, BACKGROUND)]
        numbers = {BACKGROUND: 0, **{n: i + 1 for i, n in enumerate(drawn_names)}, IGNORE: UNLABELED}
    public: list[Drawing] = []
    if (capture / "ground_truth").is_dir():
        public = painted(capture, "ground_truth")
    elif (capture / "instances").is_dir():
        public = painted(capture, "instances", SHOWN)
        # One of its objects has the number that elsewhere means a pixel without annotation.
        numbers = {n: (v if v != UNLABELED else 1) for n, v in numbers.items()}
        public = [Drawing(d.camera, np.where(d.labels == UNLABELED, 1, d.labels).astype(np.uint8)) for d in public]
    other = outlined(capture, outlines, numbers) if outlines.is_file() else []
    return Truth(capture, tuple(public), tuple(other), numbers, said)


def bare_scene(captures: Path, name: str, setting: Setting) -> Scene:
    """The scene of a capture, not embedded."""
    scenes = captures.parent / "scenes"
    scene = load(scenes / f"{name}.ply") if (scenes / f"{name}.ply").is_file() else scene_of(captures / name)
    return scene if setting.bare else replace(scene, cameras=read_capture(captures / name).cameras)


def encoder_of(captures: Path, setting: Setting) -> Encoder:
    """The encoder of a setting."""
    if not setting.coco:
        return encoders.load("auto")
    return wrap([(name,) for name in COCO], np.load(captures.parent / "clip_vectors" / "coco_clip_a+cname.npy"))


def sources(capture: Path, setting: Setting) -> list[Masker]:
    """The sources of masks of a setting, as `embed` takes them from a user."""
    named = f"folder:{capture / 'masks'}" if setting.masks == "folder" else None
    found = list(masks.load_all(named, capture)[0]) if setting.photographs else []
    if setting.masks == "true":
        found.append(Given(tuple(_true_masks(capture))))
    return found


def _true_masks(capture: Path) -> Iterator[ViewMasks]:
    """True masks of every `EVERY`th photograph that is not judged by, at half size and without names."""
    names = sorted(set(cameras(capture)) - set(SHOWN))[::EVERY]
    for drawing in painted(capture, "instances", names):
        labels = drawing.labels[::2, ::2]
        present = [v for v in np.unique(drawing.labels).tolist() if v]
        ids = np.full(labels.shape, masks.NONE, np.int32)
        for i, value in enumerate(present):
            ids[labels == value] = i
        eye = drawing.camera.resized(labels.shape[1], labels.shape[0])
        yield ViewMasks(eye, ids, ("",) * len(present), np.ones(len(present), np.float32))


def embedded(captures: Path, name: str, setting: Setting, encoder: Encoder) -> tuple[Scene, float]:
    """The embedded scene, and the seconds of the processor that it took."""
    scene, given = bare_scene(captures, name, setting), sources(captures / name, setting)
    start = time.process_time()
    made = embed(scene, encoder, masks=given or None)
    return made, time.process_time() - start
