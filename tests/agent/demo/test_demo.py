"""The demo, with an embedding that knows the truth: what is said fits the room, and everything is left behind."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from scenewright.agent.demo.run import FILES, Demo
from scenewright.agent.demo.script import SCRIPT, Targets, Thing
from scenewright.agent.session.log import read_log
from scenewright.gaussians import assets
from scenewright.gaussians.errors import UserError
from scenewright.gaussians.files import load
from scenewright.gaussians.language import encoders
from scenewright.gaussians.language.encoders.calibration import Calibration
from scenewright.gaussians.language.encoders.vocabulary import Vocabulary
from scenewright.gaussians.language.field import embed as embedding
from scenewright.gaussians.language.field.language_field import Group, LanguageField
from scenewright.gaussians.language.field.measure import box_of, lab_of_cloud
from scenewright.gaussians.scene import Scene
from scenewright.tools.judging import appearance


class Oracle:
    """Every kind is an axis of its own."""

    fingerprint = "oracle:1"
    image_size = 32

    def __init__(self) -> None:
        self.vocabulary = Vocabulary({k: () for k in assets.kinds()}, {}, ("a part",))
        self.dim = len(self.vocabulary.names)
        self.calibration = Calibration(30.0, 0.5)

    def encode_text(self, texts: list[str]) -> NDArray[np.float32]:
        rows = np.zeros((len(texts), self.dim), np.float32)
        for row, text in zip(rows, texts, strict=True):
            row[[self.vocabulary.names.index(k) for k in self.vocabulary.covered(text)]] = 1
        return rows / np.maximum(np.linalg.norm(rows, axis=1, keepdims=True), 1e-9)

    def unknown_words(self, text: str) -> tuple[str, ...]:
        return ()

    def knows(self, text: str) -> bool:
        return bool(self.vocabulary.covered(text))


def _embed_truth(room: assets.Room, oracle: Oracle, scene: Scene) -> Scene:
    """The language field that the builder's own list gives."""
    ids = room.truth.ids.numpy().astype(np.int32)
    groups = []
    for i, thing in enumerate(room.truth.objects):
        rows = scene.cloud[room.truth.ids == thing.id]
        box, lab = box_of(rows, scene.frame), lab_of_cloud(rows)
        groups.append(Group(i, "object", -1, thing.kind, 1.0, box, lab, len(rows), 4, 1.0))
    order = {thing.id: i for i, thing in enumerate(room.truth.objects)}
    floor = scene.cloud[room.truth.ids < 0]
    box = box_of(floor, scene.frame)
    groups.append(Group(len(groups), "structure", -1, "floor", 1.0, box, lab_of_cloud(floor), len(floor), 4, 1.0))
    column = np.array([order.get(int(i), len(groups) - 1) for i in ids], np.int32)
    import torch

    vectors = oracle.encode_text([g.label for g in groups])
    field = LanguageField(tuple(groups), vectors, oracle.fingerprint)
    return scene.replace(cloud=scene.cloud.replace(group=torch.from_numpy(column)), language=field)


@pytest.fixture
def oracle(monkeypatch: pytest.MonkeyPatch) -> Oracle:
    """The room is embedded by its truth, everything after that is the real line."""
    oracle = Oracle()
    rooms: list[assets.Room] = []
    furnish = assets.furnish

    def remember(seed: int, *args: Any, **options: Any) -> assets.Room:
        rooms.append(furnish(seed, *args, **{**options, "detail": 0.4}))
        return rooms[-1]

    monkeypatch.setattr(assets, "furnish", remember)
    monkeypatch.setattr(encoders, "load", lambda spec="auto": oracle)
    monkeypatch.setattr(appearance, "is_judge_of", lambda encoder, scene: False)  # the oracle reads no pictures
    monkeypatch.setattr(
        embedding, "embed", lambda scene, encoder, progress=None: _embed_truth(rooms[-1], oracle, scene)
    )
    return oracle


@pytest.mark.parametrize("seed", [0, pytest.param(5, marks=pytest.mark.slow)])
def test_the_demo_leaves_everything_behind(tmp_path: Path, oracle: Oracle, seed: int) -> None:
    said: list[str] = []
    demo = Demo(tmp_path / "demo", seed, size=(160, 120), say=said.append)
    data = demo.run()
    assert len(demo.steps) >= 8
    good = [s.good for s in demo.steps]
    assert good.count(False) == 1  # only what is not there is refused
    assert all(s.overlap is None or s.overlap > 0.99 for s in demo.steps)  # the oracle knows what is meant
    there = set(data["files"])
    assert set(FILES) <= there and {f for s in demo.steps for f in s.files} <= there
    kinds = [r["kind"] for r in read_log(tmp_path / "demo" / "session.jsonl").records]
    assert {"open", "embed", "do", "undo", "failed", "save"} <= set(kinds)
    assert len(load(tmp_path / "demo" / "edited.ply").cloud) != len(load(tmp_path / "demo" / "room.ply").cloud)
    with pytest.raises(UserError, match="--force"):
        Demo(tmp_path / "demo", seed).run()


def test_what_is_said_speaks_of_what_is_there() -> None:
    things = [Thing(0, "sofa", "red", 900), Thing(1, "coffee table", "brown", 500), Thing(2, "rug", "blue", 400),
              Thing(3, "chair", "green", 300), Thing(4, "chair", "gray", 200)]  # fmt: skip
    targets = Targets(things, ["piano"], {0})
    turns = {name: list(role(targets)) for name, role in SCRIPT}
    assert (
        turns["select"][0].text == "select the brown coffee table"
    )  # the sofa was spoken of, a rug is no good to move
    assert turns["an absent thing"][0].text == "remove the piano"
    assert turns["an ambiguous thing"][0].text == "paint the chair yellow"
    assert turns["insert"][0].text == "put a vase on the coffee table"
    assert not any("chair" in t.text for name in ("delete", "move", "two in one") for t in turns[name])
    assert not any("move the rug" in t.text for t in turns["move"])
