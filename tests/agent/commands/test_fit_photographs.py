"""`scenewright fit` on photographs without poses: what it says first, what it keeps, what it left out. What finds
poses is stood in for."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from scenewright.agent import cli
from scenewright.gaussians.camera import Camera
from scenewright.gaussians.files.captures.capture import read_capture, to_transforms
from scenewright.gaussians.fit.photographs import pose_estimation
from scenewright.gaussians.lens import Lens


def test_photographs_alone_become_a_scene(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "photos"
    folder.mkdir()
    rng = np.random.default_rng(0)
    for i in range(12):
        noise = rng.integers(0, 256, (24, 32, 3), dtype=np.uint8)
        Image.fromarray(noise).save(folder / f"p{i:02d}.PNG")

    def placed(photos: Sequence[Path], kept: Path, progress: object) -> tuple[str, ...]:
        """All but the last, on a circle."""
        cameras = [
            Camera.look_at((3 * math.cos(i), 3 * math.sin(i), 1), (0, 0, 0), (0, 0, 1), 32, 24, name=p.stem)
            for i, p in enumerate(photos)
        ]
        kept.mkdir()
        paths = [f"../photos/{p.name}" for p in photos[:-1]]
        told = to_transforms(cameras[:-1], [Lens()] * len(paths), paths)
        (kept / "transforms.json").write_text(json.dumps(told))
        return (photos[-1].name,)

    monkeypatch.setattr(pose_estimation, "estimate_poses", placed)
    with pytest.raises(SystemExit) as ended:
        cli.main(["fit", str(folder), "-o", str(tmp_path / "a.ply"), "--steps", "1", "--sh-degree", "0", "--json"])
    said = capsys.readouterr()
    assert ended.value.code in (0, None), said.err
    kept = tmp_path / "a.ply.poses"
    assert f"estimating them first, on the CPU, to be kept in {kept}" in said.err
    assert f"poses estimated: {kept} is a capture too" in said.err
    assert "1 of 12 photographs left out, no pose was found: p11.PNG" in said.err
    assert json.loads(said.out)["unplaced"] == ["p11.PNG"]
    assert (tmp_path / "a.ply").is_file() and len(read_capture(kept).cameras) == 11
