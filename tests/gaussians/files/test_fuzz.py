"""Fuzzing: loading any bytes returns a valid scene or raises FileError."""

from __future__ import annotations

import io
import json
import warnings
import zipfile
from pathlib import Path

import numpy as np
import pytest
import torch
from amounts import some
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from PIL import Image

from scenewright.gaussians import files
from scenewright.gaussians.errors import FileError

SHAPE = ["f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"]
PACKED = ["packed_position", "packed_rotation", "packed_scale", "packed_color"]
CHUNK = [f"{e}_{n}" for e in ("min", "max") for n in ("x", "y", "z", "scale_x", "scale_y", "scale_z", "r", "g", "b")]
fuzz = settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=some(200))


def check(path: Path) -> None:
    """Load it; a scene must be sound, a refusal must be a FileError with words."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            scene, report = files.load_with_report(path)
        except FileError as error:
            assert str(error)
            return
    cloud = scene.cloud
    assert 0 < len(cloud) == report.loaded <= report.rows
    assert all(bool(torch.isfinite(column).all()) for _, column in cloud.columns())
    assert (cloud.scales > 0).all() and (cloud.opacities > 0).all() and (cloud.opacities < 1).all()
    assert torch.allclose(cloud.quats.norm(dim=1), torch.ones(len(cloud)), atol=1e-5)


def ply(kind: str, encoding: str, rows: int, body: bytes) -> bytes:
    """A well-formed header over any body."""
    head = f"ply\nformat {encoding} 1.0\n"
    if kind == "packed":
        head += "element chunk 1\n" + "".join(f"property float {n}\n" for n in CHUNK)
        head += f"element vertex {rows}\n" + "".join(f"property uint {n}\n" for n in PACKED)
    else:
        head += f"element vertex {rows}\n" + "".join(f"property {kind} {n}\n" for n in ["x", "y", "z", *SHAPE])
    return head.encode() + b"end_header\n" + body


binary_ply = st.builds(
    ply,
    st.sampled_from(["float", "double", "uchar", "packed"]),
    st.sampled_from(["binary_little_endian", "binary_big_endian"]),
    st.integers(0, 5),
    st.binary(min_size=0, max_size=600) | st.binary(min_size=500, max_size=600),
)
tokens = st.sampled_from(
    ["0", "1", "-1e30", "1e400", "nan", "inf", "-inf", "x", "0x1", "1_0", "\x00", "４", "5000000000"]
)
ascii_ply = st.builds(
    lambda kind, rows, lines: ply(kind, "ascii", rows, "\n".join(" ".join(line) for line in lines).encode()),
    st.sampled_from(["float", "packed"]),
    st.integers(0, 3),
    st.lists(st.lists(tokens, min_size=14, max_size=18), max_size=5),
)
words = st.sampled_from(
    [
        *("ply", "format", "ascii", "binary_little_endian", "1.0", "element", "vertex", "chunk", "property", "float"),
        *("uint", "list", "comment", "scenewright", "frame", "end_header", "3", "-1", "\n", "\r\n", "\x00", "{}"),
        *SHAPE,
    ]
)
headers = st.lists(words, max_size=60).map(lambda parts: b"ply\n" + " ".join(parts).encode())


@fuzz
@given(binary_ply | ascii_ply | headers | st.binary(max_size=200))
def test_ply(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "a.ply"
    path.write_bytes(content)
    check(path)


@fuzz
@given(st.data())
def test_real_files_with_bytes_exchanged(tmp_path: Path, data: st.DataObject) -> None:
    rng = np.random.default_rng(0)
    content = bytearray(ply("float", "binary_little_endian", 9, rng.normal(size=9 * 14).astype("<f4").tobytes()))
    for _ in range(data.draw(st.integers(1, 6))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    path = tmp_path / "a.ply"
    path.write_bytes(content[: data.draw(st.integers(len(content) // 2, len(content)))])
    check(path)


def sog_parts() -> dict[str, bytes]:
    rng = np.random.default_rng(0)
    book = np.linspace(-3, 3, 256).tolist()
    meta = {
        "version": 2,
        "count": 16,
        "means": {"mins": [-1, -1, -1], "maxs": [1, 1, 1], "files": ["l.webp", "u.webp"]},
        "scales": {"codebook": book, "files": ["s.webp"]},
        "quats": {"files": ["q.webp"]},
        "sh0": {"codebook": book, "files": ["c.webp"]},
    }
    parts = {"meta.json": json.dumps(meta).encode()}
    for name in "lusqc":
        out = io.BytesIO()
        Image.fromarray(rng.integers(0, 256, (4, 4, 4), dtype=np.uint8)).save(out, "WEBP", lossless=True, exact=True)
        parts[f"{name}.webp"] = out.getvalue()
    return parts


PARTS = sog_parts()
KEYS = sorted(json.loads(PARTS["meta.json"]))
json_values = st.recursive(
    st.none() | st.booleans() | st.integers(-(2**70), 2**70) | st.floats() | st.text(max_size=9),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=8,
)


@fuzz
@given(
    st.sampled_from(sorted(json.loads(PARTS["meta.json"]))), st.none() | st.sampled_from(["files", "mins"]), json_values
)
def test_sog_meta(tmp_path: Path, key: str, inner: str | None, value: object) -> None:
    meta = json.loads(PARTS["meta.json"])
    if inner and isinstance(meta[key], dict):
        meta[key][inner] = value
    else:
        meta[key] = value
    for name, data in {**PARTS, "meta.json": json.dumps(meta).encode()}.items():
        (tmp_path / name).write_bytes(data)
    check(tmp_path)


@fuzz
@given(st.data())
def test_sog_archives_with_bytes_exchanged(tmp_path: Path, data: st.DataObject) -> None:
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", data.draw(st.sampled_from([zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED]))) as file:
        for name, part in PARTS.items():
            file.writestr(name, part)
    content = bytearray(out.getvalue())
    for _ in range(data.draw(st.integers(0, 6))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    path = tmp_path / "a.sog"
    path.write_bytes(content[: data.draw(st.integers(len(content) // 2, len(content)))])
    check(path)


def test_the_parts_of_the_fuzz_are_a_scene(tmp_path: Path) -> None:
    """Otherwise every example above would fail at the first check."""
    for name, part in PARTS.items():
        (tmp_path / name).write_bytes(part)
    assert len(files.load(tmp_path).cloud) == 16


@pytest.mark.parametrize("rows", [10**6, 10**12, 10**18])
def test_a_promise_allocates_nothing(tmp_path: Path, rows: int, monkeypatch: pytest.MonkeyPatch) -> None:
    largest = 0
    real = np.empty

    def watched(shape: int | tuple[int, ...], *rest: object, **kw: object) -> np.ndarray:
        nonlocal largest
        largest = max(largest, int(np.prod(shape, dtype=np.float64)))
        return real(shape, *rest, **kw)  # type: ignore[call-overload, no-any-return]

    monkeypatch.setattr(np, "empty", watched)
    path = tmp_path / "a.ply"
    for kind in ("float", "packed"):
        for encoding in ("binary_little_endian", "ascii"):
            path.write_bytes(ply(kind, encoding, rows, b"0 " * 400))
            check(path)
    assert largest < 10_000
