"""Damaged and forged files of every format give a valid scene or a FileError, within a bound on memory."""

from __future__ import annotations

import io
import json
import struct
import tracemalloc
import zipfile
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import torch
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from scenewright.gaussians import files
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.errors import FileError
from scenewright.gaussians.files.formats import splat, spz
from scenewright.gaussians.scene import Scene

SUFFIXES = (".ply", ".compressed.ply", ".splat", ".spz", ".2.spz", ".sog")
COUNT = 2000
# Memory that a refusal may take besides ten times the file: objects of Python and zipfile, the error message, and what
# a file of any size is allowed to ask for (an image of `sog._SPARE_PIXELS` RGBA pixels).
SPARE = 2 << 20
fuzz = settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=120)


@cache
def sound(suffix: str) -> bytes:
    """The bytes of a random scene of degree 1."""
    g = torch.Generator().manual_seed(1)
    cloud = GaussianCloud.create(
        torch.randn(COUNT, 3, generator=g), torch.nn.functional.normalize(torch.randn(COUNT, 4, generator=g)),
        torch.rand(COUNT, 3, generator=g) + 0.01, torch.rand(COUNT, generator=g) * 0.9 + 0.05,
        torch.randn(COUNT, 4, 3, generator=g) * 0.3,
    )  # fmt: skip
    out = io.BytesIO()
    if suffix == ".2.spz":
        spz.write(Scene(cloud), out, 2)
    else:
        files.writer(Path(f"a{suffix}"))(Scene(cloud), out)
    return out.getvalue()


def check(path: Path, content: bytes) -> None:
    """Load it; a scene must be sound, a refusal must be a FileError that cost no more than it may."""
    path.write_bytes(content)
    tracemalloc.start()
    try:
        cloud = files.load(path).cloud
    except FileError as error:
        assert str(error)
        assert tracemalloc.get_traced_memory()[1] <= 10 * len(content) + SPARE
        return
    finally:
        tracemalloc.stop()
    assert len(cloud) > 0
    assert all(bool(torch.isfinite(column).all()) for _, column in cloud.columns())
    assert (cloud.scales > 0).all() and (cloud.opacities > 0).all() and (cloud.opacities < 1).all()
    assert torch.allclose(cloud.quats.norm(dim=1), torch.ones(len(cloud)), atol=1e-5)


@fuzz
@given(st.data(), st.sampled_from(SUFFIXES))
def test_bytes_exchanged_and_cut(tmp_path: Path, data: st.DataObject, suffix: str) -> None:
    content = bytearray(sound(suffix))
    near = st.integers(0, min(800, len(content) - 1))  # headers, where lies matter most
    for _ in range(data.draw(st.integers(0, 5))):
        content[data.draw(near | st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    end = data.draw(st.just(len(content)) | st.integers(0, len(content)))
    check(tmp_path / f"a{suffix}", bytes(content[:end]))


@fuzz
@given(st.data(), st.sampled_from([32, 64, 8, 16]))
def test_numbers_exchanged_in_plain_spz_headers(tmp_path: Path, data: st.DataObject, bits: int) -> None:
    content = bytearray(sound(".spz"))
    at = data.draw(st.integers(4, 127))
    number = data.draw(st.sampled_from([0, 1, 2**bits - 1, 2 ** (bits - 1), COUNT + 1]) | st.integers(0, 2**bits - 1))
    width = bits // 8
    content[at : at + width] = (number % 2**bits).to_bytes(width, "little")
    check(tmp_path / "a.spz", bytes(content))


@fuzz
@given(st.binary(max_size=400), st.sampled_from(SUFFIXES))
def test_any_bytes(tmp_path: Path, content: bytes, suffix: str) -> None:
    check(tmp_path / f"a{suffix}", content)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_the_files_of_the_fuzz_are_sound(tmp_path: Path, suffix: str) -> None:
    (tmp_path / f"a{suffix}").write_bytes(sound(suffix))
    assert len(files.load(tmp_path / f"a{suffix}").cloud) == COUNT


def archive(parts: dict[str, bytes], method: int = zipfile.ZIP_STORED) -> bytes:
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", method) as file:
        for name, part in parts.items():
            file.writestr(name, part)
    return out.getvalue()


def sog_parts() -> dict[str, bytes]:
    with zipfile.ZipFile(io.BytesIO(sound(".sog"))) as file:
        return {name: file.read(name) for name in file.namelist()}


@pytest.mark.parametrize("name", ["means_l.webp", "quats.webp", "shN_centroids.webp", "shN_labels.webp"])
def test_pictures_that_lie_about_their_size(tmp_path: Path, name: str) -> None:
    """A lossless WebP says width and height in 14 bits each after its signature byte."""
    parts = sog_parts()
    picture = bytearray(parts[name])
    assert picture[12:16] == b"VP8L" and picture[20] == 0x2F
    kept = struct.unpack_from("<I", picture, 21)[0] >> 28 << 28
    struct.pack_into("<I", picture, 21, kept | 8191 << 14 | 8191)  # 8,192 by 8,192 pixels: a quarter of a gigabyte
    path = tmp_path / "a.sog"
    check(path, archive({**parts, name: bytes(picture)}))
    with pytest.raises(FileError, match="is larger"):
        files.load(path)


def test_archives_that_inflate(tmp_path: Path) -> None:
    parts = {**sog_parts(), "means_l.webp": bytes(200 << 20)}
    path = tmp_path / "a.sog"
    check(path, archive(parts, zipfile.ZIP_DEFLATED))
    with pytest.raises(FileError, match=r"means_l\.webp is larger"):
        files.load(path)


def test_archives_that_hide_their_size(tmp_path: Path) -> None:
    """The directory says 100 bytes; the entry inflates to two hundred million."""
    content = bytearray(archive({**sog_parts(), "means_l.webp": bytes(200 << 20)}, zipfile.ZIP_DEFLATED))
    while (at := content.find(struct.pack("<I", 200 << 20))) >= 0:
        struct.pack_into("<I", content, at, 100)
    path = tmp_path / "a.sog"
    check(path, bytes(content))
    with pytest.raises(FileError, match="not a valid zip"):
        files.load(path)


def test_meta_json_of_many_gaussians_is_refused_before_any_picture(tmp_path: Path) -> None:
    parts = sog_parts()
    meta = json.loads(parts["meta.json"])
    for count in (10**6, 10**9):
        meta["count"] = count
        path = tmp_path / "a.sog"
        check(path, archive({**parts, "meta.json": json.dumps(meta).encode()}))
        with pytest.raises(FileError, match="do not fit into"):
            files.load(path)


@pytest.mark.parametrize("size", [0, 1, 31, 33, 63])
def test_splat_files_of_broken_rows(tmp_path: Path, size: int) -> None:
    (tmp_path / "a.splat").write_bytes(bytes(size))
    with pytest.raises(FileError, match="32 bytes for each Gaussian"):
        files.load(tmp_path / "a.splat")


def test_splat_rows_that_are_faulty_are_left_out(tmp_path: Path) -> None:
    row = np.zeros(4, splat._ROW)
    row["scale"], row["quat"], row["rgba"] = 0.1, (255, 128, 128, 128), 200
    row["mean"][1, 2], row["scale"][2, 0], row["scale"][3, 1] = np.nan, -0.1, 0.0
    (tmp_path / "a.splat").write_bytes(row.tobytes())
    scene, report = files.load_with_report(tmp_path / "a.splat")
    assert scene.cloud.ids.tolist() == [0, 3] and "2 of 4" in report.notes[0]
    assert scene.cloud.quats[0].tolist() == [1, 0, 0, 0] and float(scene.cloud.scales[1, 1]) > 0
