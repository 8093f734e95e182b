"""`embed --masks`: from a folder of masks and text vectors to words that later commands understand."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.files import save
from scenewright.gaussians.files.captures.capture import read_capture
from scenewright.gaussians.render import render
from scenewright.gaussians.scene import Scene

NAMES = ("stool", "bin", "crate")


@pytest.fixture
def files(boxes: Scene, tmp_path: Path) -> Path:
    """A scene file, its capture, masks of it by name, and text vectors of the names."""
    save(boxes.replace(language=None, cameras=()), tmp_path / "boxes.ply")
    frames = []
    (tmp_path / "masks").mkdir()
    for i, angle in enumerate(np.linspace(0, 2 * np.pi, 12, endpoint=False)):
        eye = [7 * np.cos(angle), 7 * np.sin(angle), 3.0]
        camera = Camera.look_at(eye, [0, 0, 0.3], [0, 0, 1], 96, 72, 45, f"view{i}")
        ids = render(boxes.cloud, camera).group.numpy()
        np.savez(tmp_path / "masks" / f"view{i}.npz", ids=np.where(ids < 3, ids, -1), labels=np.array(NAMES))
        pose = np.linalg.inv(camera.world_to_camera)
        pose[:3, 1:3] *= -1  # OpenCV to OpenGL axes
        frames.append({"file_path": f"photos/view{i}.jpg", "transform_matrix": pose.tolist()})
    shared = {"fl_x": camera.fx, "fl_y": camera.fy, "cx": 48.0, "cy": 36.0, "w": 96, "h": 72}
    (tmp_path / "transforms.json").write_text(json.dumps({**shared, "frames": frames}))
    np.save(tmp_path / "text.npy", np.eye(5, 8, dtype=np.float32))
    (tmp_path / "names.json").write_text(json.dumps([*NAMES, "sofa", "lamp"]))
    return tmp_path


@pytest.mark.slow
def test_masks_name_what_text_vectors_then_find(files: Path, call: Any) -> None:
    spec = f"vectors:{files / 'text.npy'},{files / 'names.json'}"
    masks, capture = f"folder:{files / 'masks'}", files / "transforms.json"
    code, out, err = call(
        "embed",
        files / "boxes.ply",
        "--masks",
        masks,
        "--capture",
        capture,
        "--encoder",
        spec,
        "--up",
        "0,0,1",
        "--json",
    )
    assert code == 0, err
    told = json.loads(out)
    assert {t["label"] for t in told["things"]} >= set(NAMES) and any("masks" in note for note in told["notes"])
    code, out, err = call("select", files / "boxes.ply", "the bin", "--encoder", spec, "--json")
    assert code == 0, err
    assert json.loads(out)["verdict"] == "found"
    code, _, _ = call("select", files / "boxes.ply", "the sofa", "--encoder", spec, "--json")
    assert code == 3


@pytest.mark.parametrize(
    ("arguments", "code", "said"),
    [
        (("--masks", "magic"), 4, "unknown source of masks"),
        (("--masks", "folder:nowhere"), 4, "no masks at"),
        (("--capture", "nowhere.json"), 4, "a capture is a transforms.json, or a folder"),
    ],
)
def test_a_source_that_is_none_is_named(
    files: Path, call: Any, arguments: tuple[str, ...], code: int, said: str
) -> None:
    found, _, err = call("embed", files / "boxes.ply", *arguments)
    assert found == code and said in err


def test_missing_photographs_are_said(tmp_path: Path, boxes: Scene, files: Path, call: Any) -> None:
    own = tmp_path / "own.ply"
    save(boxes.replace(cameras=read_capture(files).cameras), own)
    code, _, err = call("embed", own, "--capture", tmp_path / "nowhere.json")
    assert code == 4 and "nowhere.json" in err
    code, _, err = call("embed", own, "--capture", files, "--masks", f"folder:{files / 'masks'}")
    assert code == 0 and "are missing: only the masks of folder:" in err
