"""A motion on disk: exact, bound to its scene file, kept by every format, and never trusted when damaged."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from safetensors.torch import load_file, save_file
from torch import Tensor

from scenewright.gaussians import files
from scenewright.gaussians.errors import FileError
from scenewright.gaussians.files.fingerprint import fingerprint
from scenewright.gaussians.files.motion_file import motion_path, save_motion
from scenewright.gaussians.motion.at import at
from scenewright.gaussians.motion.motion import Motion, Track, carried, without_ids
from scenewright.gaussians.scene import Scene
from tests.support.moving_balls import moving


def bare(scene: Scene) -> Scene:
    """The scene with what its file keeps."""
    return scene.replace(language=None, cloud=scene.cloud.replace(group=torch.full_like(scene.cloud.group, -1)))


def test_a_motion_is_read_as_it_was_written(tmp_path: Path) -> None:
    scene = bare(moving())
    files.save(scene, tmp_path / "a.ply")
    back = files.load(tmp_path / "a.ply")
    assert scene.motion is not None and back.motion is not None
    for was, now in zip(scene.motion.tracks, back.motion.tracks, strict=True):
        assert (was.kind, was.smooth, was.name) == (now.kind, now.smooth, now.name)
        for name in ("runs", "times", "quats", "offsets", "pivot"):
            np.testing.assert_array_equal(getattr(was, name), getattr(now, name))
    for look, again in zip(scene.motion.looks, back.motion.looks, strict=True):
        assert (look.start, look.stop, look.ids.tolist()) == (again.start, again.stop, again.ids.tolist())
    for time in (0.5, 1.7, 2.7):
        # A PLY keeps float32 logits of opacities and logarithms of scales, and means to the bit.
        assert torch.equal(at(back, time).cloud.means, at(scene, time).cloud.means)
        torch.testing.assert_close(at(back, time).cloud.sh, at(scene, time).cloud.sh)
    first = motion_path(tmp_path / "a.ply").read_bytes()
    files.save(scene, tmp_path / "a.ply", force=True)
    assert motion_path(tmp_path / "a.ply").read_bytes() == first


def test_a_turned_path_is_read_as_it_was_written(tmp_path: Path) -> None:
    scene = bare(moving(0, 120))
    quarter = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    turned = scene.replace(motion=carried(scene.motion, scene.cloud.ids.numpy(), quarter, np.zeros(3)))
    files.save(turned, tmp_path / "a.ply")
    back = files.load(tmp_path / "a.ply")
    assert torch.equal(at(back, 1.3).cloud.means, at(turned, 1.3).cloud.means)


def test_a_path_of_which_a_part_was_moved_is_written(tmp_path: Path) -> None:
    scene = bare(moving(0, 120))
    assert scene.motion is not None
    some = scene.motion.tracks[2].ids[:5]
    divided = scene.replace(motion=carried(scene.motion, some, np.eye(3), np.ones(3)))
    files.save(divided, tmp_path / "a.ply")
    back = files.load(tmp_path / "a.ply")
    assert back.motion is not None and len(back.motion.tracks) == 5
    assert torch.equal(at(back, 1.3).cloud.means, at(divided, 1.3).cloud.means)


def test_a_static_scene_has_no_file_and_takes_away_that_of_the_one_before(tmp_path: Path) -> None:
    scene = bare(moving())
    files.save(scene.replace(motion=None), tmp_path / "a.ply")
    assert [p.name for p in tmp_path.iterdir()] == ["a.ply"]
    files.save(scene, tmp_path / "a.ply", force=True)
    assert motion_path(tmp_path / "a.ply").is_file()
    files.save(scene.replace(motion=None), tmp_path / "a.ply", force=True)
    assert [p.name for p in tmp_path.iterdir()] == ["a.ply"]


@pytest.mark.parametrize("suffix", [".compressed.ply", ".spz", ".sog", ".splat"])
def test_every_format_keeps_it_through_its_order_of_rows(tmp_path: Path, suffix: str) -> None:
    scene = bare(moving())
    files.save(scene, tmp_path / f"a{suffix}")
    back = files.load(tmp_path / f"a{suffix}")
    there, here = at(back, 2.0).cloud.means, at(scene, 2.0).cloud.means
    # Rows may have another order: each is nearest to itself, within the step of packed positions.
    assert float(torch.cdist(here, there).min(dim=1).values.max()) < 0.01
    shifted = torch.cdist(scene.cloud.means, there).min(dim=1).values
    assert float(shifted.max()) > 0.5


def test_ids_become_row_numbers_and_those_that_are_gone_are_left_out(tmp_path: Path) -> None:
    scene = bare(moving())
    rows = torch.randperm(len(scene.cloud), generator=torch.Generator().manual_seed(0))[:100]
    part = scene.replace(cloud=scene.cloud[rows])
    files.save(part, tmp_path / "a.ply")
    back = files.load(tmp_path / "a.ply")
    assert torch.equal(back.cloud.ids, torch.arange(100))
    for time in (1.0, 2.7):
        assert torch.equal(at(back, time).cloud.means, at(part, time).cloud.means)


def test_a_motion_of_another_file_is_left_out_and_said_so(tmp_path: Path) -> None:
    scene = bare(moving())
    files.save(scene, tmp_path / "a.ply")
    saved = motion_path(tmp_path / "a.ply").read_bytes()
    files.save(scene.replace(cloud=scene.cloud[1:], motion=None), tmp_path / "a.ply", force=True)
    motion_path(tmp_path / "a.ply").write_bytes(saved)
    back, report = files.load_with_report(tmp_path / "a.ply")
    assert back.motion is None
    assert [n for n in report.notes if "another version of this file" in n]


def forged(path: Path, tensors: dict[str, Tensor] | None = None, **table: Any) -> None:
    """Write the motion beside a scene again with other tensors and entries of its table."""
    from safetensors import safe_open

    target = motion_path(path)
    with safe_open(target, framework="pt") as stream:
        header = json.loads(stream.metadata()["scenewright.motion"])
    kept = load_file(target)
    save_file({**kept, **(tensors or {})}, target, {"scenewright.motion": json.dumps({**header, **table})})


BAD: list[tuple[dict[str, Tensor], dict[str, Any], str]] = [
    ({"track.0.times": torch.tensor([0.0, math.nan], dtype=torch.float64)}, {}, "finite"),
    ({"track.0.times": torch.tensor([0.0], dtype=torch.float64)}, {}, "shape"),
    ({"track.1.runs": torch.tensor([[0, 1 << 60]])}, {}, "does not have"),
    ({"track.1.runs": torch.tensor([[5, 2]])}, {}, "disjoint"),
    ({"track.2.quats": torch.zeros(2, 4, dtype=torch.float64)}, {}, "length one"),
    ({"track.2.frame": torch.ones(3, 3, dtype=torch.float64)}, {}, "orthogonal"),
    ({"track.2.offsets": torch.ones(2, 3, dtype=torch.float64)}, {}, "not at rest"),
    ({"look.0.ids": torch.tensor([1, 10**9])}, {}, "does not have"),
    ({"look.1.opacities": torch.full((3,), math.nan)}, {}, "opacities"),
    ({"residual.0.weights": torch.full((1, 1, 3), math.inf)}, {}, "finite"),
    ({"residual.0.ids": torch.tensor([1.0])}, {}, "rows"),
    ({}, {"residuals": 2}, "residual.1"),
    ({}, {"residuals": 10**9}, "residuals"),
    ({}, {"stop": -3.0}, "later stop"),
    ({}, {"tracks": [{"kind": "flies", "smooth": True, "name": ""}]}, "kind"),
    ({}, {"more": 1}, "more"),
]


@pytest.mark.parametrize(("tensors", "table", "said"), BAD, ids=[said for _, _, said in BAD])
def test_a_forged_motion_is_refused(
    tmp_path: Path, tensors: dict[str, Tensor], table: dict[str, Any], said: str
) -> None:
    path = tmp_path / "a.ply"
    files.save(bare(moving(0, 120)), path)
    forged(path, tensors, **table)
    with pytest.raises(FileError, match=r"a\.ply\.motion\.safetensors is damaged .*delete it to load") as refused:
        files.load(path)
    chain = str(refused.value) + str(refused.value.__cause__)
    assert said in chain


def test_a_cut_off_motion_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.ply"
    files.save(bare(moving(0, 120)), path)
    whole = motion_path(path).read_bytes()
    for length in (0, 7, 100, len(whole) // 2, len(whole) - 1):
        motion_path(path).write_bytes(whole[:length])
        with pytest.raises(FileError, match="is damaged"):
            files.load(path)
    motion_path(path).write_bytes(whole + b"more")
    with pytest.raises(FileError, match="is damaged"):
        files.load(path)


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(st.tuples(st.integers(0, 10**6), st.integers(0, 255)), min_size=1, max_size=4))
def test_flipped_bytes_give_a_sound_motion_or_a_refusal(tmp_path: Path, flips: list[tuple[int, int]]) -> None:
    path = tmp_path / "a.ply"
    if not path.exists():
        files.save(bare(moving(0, 60)), path)
        (tmp_path / "sound").write_bytes(motion_path(path).read_bytes())
    data = bytearray((tmp_path / "sound").read_bytes())
    for place, value in flips:
        data[place % len(data)] = value
    motion_path(path).write_bytes(bytes(data))
    try:
        scene = files.load(path)
    except FileError as error:
        assert "motion" in str(error)
        return
    assert bool(at(scene, 1.3).cloud.means.isfinite().all())


def test_another_version_is_left_out(tmp_path: Path) -> None:
    path = tmp_path / "a.ply"
    files.save(bare(moving(0, 120)), path)
    forged(path, version=2)
    back, report = files.load_with_report(path)
    assert back.motion is None and "another version of scenewright" in report.notes[-1]


def test_a_motion_that_moves_nothing_here_has_no_file(tmp_path: Path) -> None:
    scene = bare(moving(0, 120))
    files.save(scene.replace(motion=None), tmp_path / "a.ply")
    elsewhere = Motion((Track.spin([10**6], 1.0, (0, 0, 1), (0, 0, 0)),), stop=1.0)
    assert save_motion(scene.replace(motion=elsewhere), tmp_path / "a.ply") is None
    assert without_ids(elsewhere, [10**6]) is None
    assert fingerprint(tmp_path / "a.ply")
