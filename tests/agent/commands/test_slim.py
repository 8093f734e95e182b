"""`scenewright slim`: writes the file with its language field, keeps its promise, and refuses before it works."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from scenewright.gaussians import files
from scenewright.gaussians.language.field.loading import load
from scenewright.gaussians.language.field.store import field_path, save_field
from scenewright.gaussians.scene import Scene

SMALL = ("--pixels", 64)


@pytest.fixture
def room(boxes: Scene, tmp_path: Path) -> Path:
    """The boxes with their language field."""
    files.save(boxes, tmp_path / "room.ply")
    save_field(boxes, tmp_path / "room.ply")
    return tmp_path / "room.ply"


@pytest.mark.slow
def test_the_file_its_field_and_the_map_of_ids(call: Any, room: Path, tmp_path: Path) -> None:
    small, ids = tmp_path / "small.sog", tmp_path / "ids.npy"
    code, out, err = call("slim", room, "-o", small, "--psnr", 30, "--ids", ids, *SMALL, "--json")
    assert code == 0, err
    told = json.loads(out)
    before, after, kept = load(room), load(small), np.load(ids)
    assert told["bytes"] == small.stat().st_size < room.stat().st_size / 4
    assert told["gaussians"] == len(after.cloud) == len(kept) <= told["gaussians_before"] == len(before.cloud)
    assert told["held_out"]["psnr"] >= 30 == told["promised_psnr"]
    assert told["things"][0] == told["things"][1] > 0
    assert told["field"] == str(field_path(small))
    assert after.language is not None and before.language is not None
    assert [g.names for g in after.language.groups] == [g.names for g in before.language.groups]
    assert (after.cloud.group.numpy() == before.cloud.group.numpy()[kept]).all()
    assert after.frame == before.frame


@pytest.mark.slow
def test_the_text_tells_size_and_loss(call: Any, room: Path, tmp_path: Path) -> None:
    code, out, _ = call("slim", room, "-o", tmp_path / "small", "--format", "spz", "--psnr", 28, *SMALL)
    assert code == 0 and (tmp_path / "small.spz").exists()
    for said in ("times smaller than as .ply", "held-out views", "28 promised", "things kept", "computed around"):
        assert said in out


def test_every_bit_is_kept_on_request(call: Any, room: Path, tmp_path: Path) -> None:
    code, out, err = call("slim", room, "-o", tmp_path / "same.ply", "--psnr", "inf")
    assert code == 0, err
    assert "every bit is kept" in out
    assert (tmp_path / "same.ply").read_bytes() == room.read_bytes()


@pytest.mark.parametrize(
    ("given", "exit_code", "said"),
    [
        (("-o", "small"), 2, "does not say its format"),
        (("-o", "small.sog", "--format", "spz"), 2, "change one of them"),
        (("-o", "small.sog", "--psnr", "-4"), 2, "positive number of decibels"),
        (("-o", "small.sog", "--psnr", "inf"), 3, r"only \.ply keeps every bit"),
        (("-o", "nowhere/small.sog"), 4, "create it first"),
        (("-o", "room.ply"), 2, "exists"),
    ],
)
def test_what_cannot_be_done_is_said_and_nothing_is_written(
    call: Any, room: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, given: Any, exit_code: int, said: str
) -> None:
    monkeypatch.chdir(tmp_path)
    before = sorted(path.name for path in tmp_path.iterdir())
    code, _, err = call("slim", room, *given, *SMALL)
    assert code == exit_code and re.search(said, err)
    assert sorted(path.name for path in tmp_path.iterdir()) == before
