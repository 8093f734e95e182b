"""Selection by sight in a real room: what a person, shown only the pictures that a model is sent, points at.

The replies were given by hand from the pictures and are kept by number. Each states the marks of its pictures;
where the pictures have other marks now, the phrase counts as not found.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from statistics import fmean
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...agent.session.session import Session
from ...gaussians.files import load
from ...gaussians.files.captures.capture import read_capture
from ...gaussians.language import encoders, masks
from ...gaussians.language.field.embed import embed
from ...gaussians.render import render
from ...gaussians.scene import Scene
from ...planners.model.backend import Answer, Message, OnText
from ...planners.plan import Usage
from .. import _data
from .._select.cases import Part
from .._select.real.drawings import Drawing, agreement, painted, silhouette
from ..harness import Metric
from .written import FOLDER

REPLIES = FOLDER / "pointed.json"
_MARKS = re.compile(r"Numbered things in it: (.*?)\.\n", re.DOTALL)
_WORTH = 100  # pixels of a label from which a group may be part of the best union


class Hand:
    """A `ModelBackend` that gives the replies of one phrase in order, as far as the pictures show the same numbers.

    Attributes:
        pictures, requests: what it was sent.
    """

    name, sees, window = "hand", True, 100_000

    def __init__(self, replies: Sequence[dict[str, Any]]) -> None:
        self._replies, self.pictures, self.requests = replies, 0, 0

    def answer(
        self, messages: Sequence[Message], schema: dict[str, Any], *, seconds: float, on_text: OnText | None = None
    ) -> Answer:
        """See `ModelBackend.answer`."""
        nothing: dict[str, Any] = {"reply": {"none": True, "confidence": 0.0}}
        known = self._replies[self.requests] if self.requests < len(self._replies) else nothing
        self.requests += 1
        self.pictures += sum(len(m.pictures) for m in messages)
        same = known.get("marks") == marks_told(messages)
        return Answer(json.dumps((known if same else nothing)["reply"]), Usage(model=self.name, requests=1))


def marks_told(messages: Sequence[Message]) -> list[str]:
    """The numbers in each picture, as the request lists them."""
    return _MARKS.findall(messages[-1].text + "\n")


def measure(quick: bool) -> Part:
    """Mean agreement of what is pointed at, beside that of the best union of groups; none where the data are absent."""
    data = _data.folder("captures")
    if quick or data is None or not REPLIES.is_file():
        return Part()
    capture = data / "bonsai_room"
    scene = embedded(capture, data.parent / "scenes" / "bonsai_room.ply")
    drawn = painted(capture, "ground_truth")
    numbered = [render(scene.cloud, d.camera).group.numpy() for d in drawn]
    ours, best, most = list[float](), list[float](), [0, 0]
    for phrase, entry in json.loads(REPLIES.read_text(encoding="utf-8")).items():
        hand = Hand(entry["replies"])
        found = Session(scene, planner="grammar", vlm=hand).select(phrase)
        shown = found.mask(scene.cloud).numpy() if found.groups else np.zeros(len(scene.cloud), bool)
        ours.append(_agreement(scene, shown, drawn, entry["label"]))
        union = best_union(scene, numbered, drawn, entry["label"])
        best.append(_agreement(scene, _members(scene, union), drawn, entry["label"]))
        most = [max(most[0], hand.pictures), max(most[1], hand.requests)]
    return Part((
        Metric("sight.mean_iou", fmean(ours), "IoU", "higher", 0.03),
        Metric("sight.best_union", fmean(best), "IoU", "higher", 0.03),
        Metric("sight.share_of_best", fmean(ours) / fmean(best), "share", "higher", 0.03, 0.9),
        Metric("sight.pictures.most", most[0], "pictures", "lower", 0.0, 3),
        Metric("sight.requests.most", most[1], "requests", "lower", 0.0, 2),
    ))  # fmt: skip


def embedded(capture: Path, scene: Path) -> Scene:
    """The real room with its photographs' cameras, embedded with the detector's masks and the default encoder."""
    bare = replace(load(scene), cameras=read_capture(capture).cameras)
    source = masks.load(f"folder:{capture / 'masks'}", capture / "transforms.json")
    return embed(bare, encoders.load("auto"), masks=source)


def best_union(scene: Scene, numbered: Sequence[NDArray[np.int32]], drawn: Sequence[Drawing], label: int) -> set[int]:
    """The objects whose union agrees best with a label, added greedily; compared in the pictures of groups."""
    owner = _owners(scene)
    shown = [np.where(image >= 0, owner[np.maximum(image, 0)], -1) for image in numbered]
    left = {
        int(g)
        for image, d in zip(shown, drawn, strict=True)
        for g, n in zip(*np.unique(image[(d.labels == label) & (image >= 0)], return_counts=True), strict=True)
        if n > _WORTH
    }

    def score(groups: Iterable[int]) -> float:
        each = [agreement(np.isin(i, list(groups)), d, (label,)) for i, d in zip(shown, drawn, strict=True)]
        return fmean(value for value in each if value is not None)

    chosen, reached = set[int](), 0.0
    while left:
        value, group = max((score(chosen | {g}), -g) for g in sorted(left))
        if value <= reached:
            break
        chosen, reached = chosen | {-group}, value
        left -= chosen
    return chosen


def _owners(scene: Scene) -> NDArray[np.int64]:
    """`[G]` the object that each group belongs to."""
    assert scene.language is not None
    return np.array([g.parent if g.parent >= 0 else g.id for g in scene.language.groups], dtype=np.int64)


def _members(scene: Scene, groups: Iterable[int]) -> NDArray[np.bool_]:
    column = scene.cloud.group.numpy()
    return (column >= 0) & np.isin(_owners(scene)[np.maximum(column, 0)], list(groups))


def _agreement(scene: Scene, shown: NDArray[np.bool_], drawn: Sequence[Drawing], label: int) -> float:
    each = [agreement(silhouette(scene, shown, d.camera), d, (label,)) for d in drawn]
    return fmean(value for value in each if value is not None)
