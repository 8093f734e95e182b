"""A header that declares fewer rows than the file holds: what it declares is read, and the rest is told."""

from __future__ import annotations

from pathlib import Path

import pytest
import torch

from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.files import load_with_report, save
from scenewright.gaussians.scene import Scene


def _written(path: Path, count: int = 20) -> bytes:
    g = torch.Generator().manual_seed(3)
    cloud = GaussianCloud.create(
        torch.randn(count, 3, generator=g), torch.tensor([1.0, 0, 0, 0]).expand(count, 4).contiguous(),
        torch.full((count, 3), 0.1), torch.full((count,), 0.5), torch.zeros(count, 1, 3),
    )  # fmt: skip
    save(Scene(cloud), path)
    return path.read_bytes()


def test_rows_beyond_the_header_are_told(tmp_path: Path) -> None:
    content = _written(tmp_path / "a.ply")
    (tmp_path / "b.ply").write_bytes(content.replace(b"element vertex 20\n", b"element vertex 12\n"))
    scene, report = load_with_report(tmp_path / "b.ply")
    assert len(scene.cloud) == 12
    assert report.notes[-1:] == (
        "the header declares 12 vertex rows, the file holds about 8 more, which were left out",
    )


@pytest.mark.parametrize("padding", [b"", b"\n", b"\0" * 8])
def test_a_whole_file_says_nothing(tmp_path: Path, padding: bytes) -> None:
    (tmp_path / "a.ply").write_bytes(_written(tmp_path / "b.ply") + padding)
    assert load_with_report(tmp_path / "a.ply")[1].notes == ()


def test_rows_of_text_beyond_the_header_are_told(tmp_path: Path) -> None:
    names = ["x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", *(f"scale_{i}" for i in range(3)),
             *(f"rot_{i}" for i in range(4))]  # fmt: skip
    header = "\n".join(
        ["ply", "format ascii 1.0", "element vertex 2", *(f"property float {n}" for n in names), "end_header"]
    )
    row = " ".join(["0.5"] * len(names))
    (tmp_path / "a.ply").write_text("\n".join([header, row, row, row, ""]))
    assert "about 1 more" in load_with_report(tmp_path / "a.ply")[1].notes[-1]
