"""A coarse level is shown first, goes bit by bit as the scene comes, and leaves nothing behind."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

from scenewright.agent.session.session import Session
from scenewright.agent.view import preview, wire
from scenewright.agent.view.changes import Shown
from scenewright.agent.view.columns import columns_of, decode, width
from scenewright.agent.view.hub import Hub
from scenewright.agent.view.preview import Preview, coarse_level
from scenewright.agent.view.slots import slots_of
from scenewright.gaussians import files
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.files.formats import streamed_sog_writing
from scenewright.gaussians.levels.making import make
from scenewright.gaussians.scene import Scene

COARSE = 60


def _cloud(count: int, degree: int, seed: int) -> GaussianCloud:
    g = torch.Generator().manual_seed(seed)
    quats = torch.nn.functional.normalize(torch.randn(count, 4, generator=g))
    return GaussianCloud.create(
        torch.rand(count, 3, generator=g), quats, torch.rand(count, 3, generator=g) * 0.1 + 0.01,
        torch.rand(count, generator=g) * 0.9 + 0.05, torch.randn(count, (degree + 1) ** 2, 3, generator=g),
        group=torch.arange(count, dtype=torch.int32) % 3,
    )  # fmt: skip


def _pages(messages: Any, degree: int) -> list[dict[str, np.ndarray[Any, Any]]]:
    """What a page holds after each message: rows of bytes by column."""
    pages: list[dict[str, np.ndarray[Any, Any]]] = []
    held = {column: np.zeros((0, width(column, degree)), np.uint8) for column in columns_of(degree)}
    for message in messages:
        header, parts = wire.read(message)
        assert header["base"] is None and header["chunk"][0] == len(pages)
        for column, rows in held.items():
            more = np.zeros((max(header["slots"] - len(rows), 0), rows.shape[1]), np.uint8)
            held[column] = np.concatenate([rows, more])
            part = parts[column]
            held[column][slots_of(part.ranges)] = np.frombuffer(part.data, np.uint8).reshape(-1, rows.shape[1])
        pages.append({column: rows.copy() for column, rows in held.items()})
    assert len(pages) == header["chunk"][1]
    return pages


@pytest.mark.parametrize("degree", [0, 2])
def test_a_coarse_level_comes_first_and_goes_bit_by_bit(degree: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(wire, "CHUNK", 100)
    fine, coarse = _cloud(730, degree, 1), _cloud(COARSE, 0, 2)
    shown = Shown.first(Scene(fine), 5)
    found = Preview.of(coarse, shown)
    pages = _pages(wire.load(shown, found), degree)
    plain = _pages(wire.load(shown), degree)
    assert len(pages) == len(plain) + 1 == 9

    behind = [decode(page["color"][730:].tobytes(), "color")["opacities"] for page in pages]
    means = decode(pages[0]["position"][730:].tobytes(), "position")["means"]
    assert np.allclose(means, coarse.means) and (behind[0] > 0).all()
    assert not pages[0]["color"][:730].any()  # of the scene nothing is there yet
    there = [int((opacities > 0).sum()) for opacities in behind]
    assert there == sorted(there, reverse=True) and there[-1] == 0 and len(set(there)) > 4
    for page, alone in zip(pages[1:], plain, strict=True):  # the scene comes as it does without
        assert all((page[column][: len(rows)] == rows).all() for column, rows in alone.items())
    assert (decode(pages[-1]["group"][730:].tobytes(), "group")["owner"] == -1).all()


def test_what_goes_is_where_the_scene_has_come(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two clusters far apart: while only the first is there, the coarse level of the second still shows."""
    apart = torch.tensor([50.0, 50.0, 50.0])
    near, far = _cloud(200, 0, 1), _cloud(200, 0, 2)
    both = torch.cat([near.means, far.means + apart])
    fine = _cloud(400, 0, 3).replace(means=both)
    coarse = _cloud(40, 0, 4)
    coarse = coarse.replace(means=torch.cat([coarse.means[:20], coarse.means[20:] + apart]))
    found = Preview.of(coarse, Shown.first(Scene(fine)))
    assert found.until[:20].max() <= 200 and found.until[20:].min() >= 200
    assert sorted(np.concatenate([found.emptied(0, 200), found.emptied(200, 400)])) == list(range(40))


def test_only_a_large_scene_that_was_not_edited_has_a_preview(
    boxes: Scene, encoder: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    coarse = _cloud(COARSE, 0, 2)

    def messages(hub: Hub) -> int:
        return len(list(hub.load(hub.shown)))

    assert messages(Hub(Session(boxes, encoder=encoder), "boxes", None, coarse=coarse)) == 1
    monkeypatch.setattr(wire, "CHUNK", 600)
    assert messages(Hub(Session(boxes, encoder=encoder), "boxes", None)) == 2
    hub = Hub(Session(boxes, encoder=encoder), "boxes", None, coarse=coarse)
    assert messages(hub) == 3
    hub.session.do("make the green thing blue")
    hub.settle()
    assert hub.shown.revision != hub._first.revision and messages(hub) == 2


def test_the_level_that_is_shown_first(boxes: Scene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    files.save(boxes.replace(language=None), tmp_path / "boxes.ply")
    streamed_sog_writing.save(make(boxes.replace(language=None), 3, ()), tmp_path / "boxes.lod")
    assert coarse_level(tmp_path / "boxes.ply") is None
    assert coarse_level(tmp_path / "boxes.lod") is None  # the finest one is small itself
    for most, count in ((1000, 293), (100, 73)):
        monkeypatch.setattr(preview, "MOST", most)
        found = coarse_level(tmp_path / "boxes.lod")
        assert found is not None and len(found) == count
    monkeypatch.setattr(preview, "MOST", 10)
    assert coarse_level(tmp_path / "boxes.lod") is None
