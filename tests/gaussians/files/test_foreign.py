"""Invalid files of other programs are refused with one clear error."""

from __future__ import annotations

import io
import json
import struct
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from PIL import Image

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.errors import BackendError, FileError
from scenewright.gaussians.files.captures.capture import read_capture
from scenewright.gaussians.files.foreign import read_archive, read_array, read_json
from scenewright.gaussians.language import encoders, masks
from scenewright.gaussians.language.masks.sources import rle
from scenewright.gaussians.scene import Scene

SCENE = Scene(GaussianCloud.empty(), cameras=(Camera.look_at([0, -3, 1], [0, 0, 0], [0, 0, 1], 16, 12, name="one"),))
BOTH = np.stack([np.arange(192).reshape(12, 16) < 48, np.arange(192).reshape(12, 16) > 90])
DEEP = "[" * 100_000  # deeper than any parser of nested calls goes


def held(**columns: Any) -> bytes:
    """The bytes of a compressed `.npz`."""
    stream = io.BytesIO()
    np.savez_compressed(stream, **columns)
    return stream.getvalue()


def lying(shape: tuple[int, ...]) -> bytes:
    """A `.npz` with one array whose header declares more bytes than follow."""
    stream = io.BytesIO()
    header = f"{{'descr': '|b1', 'fortran_order': False, 'shape': {shape}, }}".ljust(117).encode() + b"\n"
    with zipfile.ZipFile(stream, "w") as archive:
        archive.writestr("masks.npy", b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header + b"\1" * 9)
    return stream.getvalue()


def one_array() -> bytes:
    stream = io.BytesIO()
    np.save(stream, BOTH)
    return stream.getvalue()


BROKEN = {
    "empty": b"",
    "text": b"masks",
    "cut": held(masks=BOTH)[:100],
    "one array": one_array(),
    "lies": lying((9, 9, 9)),
    "asks for petabytes": lying((10**5, 10**5, 10**5)),
    "objects": held(masks=np.array([{}, None], dtype=object)),
}


@pytest.mark.parametrize("content", BROKEN.values(), ids=BROKEN)
def test_a_broken_archive_is_a_file_error(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "one.npz").write_bytes(content)
    with pytest.raises(FileError, match=r"one\.npz"):
        read_archive(tmp_path / "one.npz")


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
@given(at=st.integers(0, 10**6), value=st.integers(1, 255))
def test_an_archive_with_one_byte_changed_is_read_or_refused(tmp_path: Path, at: int, value: int) -> None:
    content = bytearray(held(masks=BOTH))
    content[at % len(content)] ^= value
    (tmp_path / "one.npz").write_bytes(content)
    try:
        read = read_archive(tmp_path / "one.npz")
    except FileError:
        return
    assert all(isinstance(array, np.ndarray) and array.dtype != object for array in read.values())


def test_an_array_is_read_as_it_is_and_nothing_else(tmp_path: Path) -> None:
    (tmp_path / "good.npy").write_bytes(one_array())
    assert (read_array(tmp_path / "good.npy") == BOTH).all()
    np.save(tmp_path / "objects.npy", np.array([{}]), allow_pickle=True)
    (tmp_path / "archive.npy").write_bytes(held(masks=BOTH))
    for name in ("objects.npy", "archive.npy", "none.npy"):
        with pytest.raises(FileError, match=name):
            read_array(tmp_path / name)


@pytest.mark.parametrize("content", [b"", b"{", b"\xff\xfe", DEEP.encode()], ids=["empty", "cut", "bytes", "deep"])
def test_what_is_no_json_is_a_file_error(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "a.json").write_bytes(content)
    with pytest.raises(FileError, match=r"a\.json is not valid JSON"):
        read_json(tmp_path / "a.json")


# -- what they hold


def refuse(folder: Path, said: str) -> None:
    with pytest.raises(FileError, match=said):
        list(masks.load(f"folder:{folder}").masks(SCENE))


@pytest.mark.parametrize(
    ("columns", "said"),
    [
        ({"masks": BOTH, "scores": np.array(["high", "low"])}, "one per mask"),
        ({"masks": BOTH, "scores": np.full(2, np.nan)}, "finite scores"),
        ({"masks": BOTH, "scores": np.ones((2, 2))}, "finite scores"),
        ({"masks": BOTH, "vectors": np.array([["a"], ["b"]])}, "one per mask"),
        ({"masks": BOTH, "vectors": np.ones((2, 3), complex)}, "one per mask"),
        ({"masks": BOTH, "vectors": np.full((2, 3), np.nan)}, "finite vectors"),
        ({"masks": BOTH, "vectors": np.ones((3, 3))}, "2 masks need 2 rows"),
        ({"masks": BOTH, "labels": np.array("a")}, "one per mask"),
        ({"masks": BOTH * 0.5}, "must be booleans"),
        ({"masks": np.zeros((2, 12, 0), bool)}, "do not fit"),
        ({"ids": np.zeros(16, int)}, "an archive needs"),
        ({"ids": np.array(3)}, "an archive needs"),
        ({"ids": np.full((12, 16), -2)}, "between -1"),
        ({"ids": np.full((12, 16), 2**40)}, "between -1"),
        ({"ids": np.full((12, 16), 2**63, np.uint64)}, "between -1"),
    ],
)
def test_archives_that_do_not_hold_together_say_why(tmp_path: Path, columns: dict[str, Any], said: str) -> None:
    (tmp_path / "one.npz").write_bytes(held(**columns))
    refuse(tmp_path, said)


def png(width: int, height: int) -> bytes:
    """A grey image whose header declares this size and whose data end after one line."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(b"\0")) + chunk(b"IEND", b"")


@pytest.mark.parametrize(
    ("index", "said"),
    [
        ('[{"id": 1}, {"id": 10000000000000}]', "must number the masks"),
        ('[{"id": 1e999}]', "readable id"),
        (f'[{{"id": 1, "score": 1{"0" * 400}}}]', "readable id"),
        ('[{"id": 1, "score": NaN}]', "finite scores"),
    ],
)
def test_an_index_of_impossible_numbers_says_so(tmp_path: Path, index: str, said: str) -> None:
    (tmp_path / "masks.json").write_text(f'{{"one.jpg": {index}}}')
    Image.fromarray(BOTH[0].astype(np.uint8)).save(tmp_path / "one.png")
    refuse(tmp_path, said)


@pytest.mark.parametrize("size", [(60_000, 45_000), (40, 30)], ids=["far too large", "cut"])
def test_a_picture_that_lies_about_its_size_is_refused(tmp_path: Path, size: tuple[int, int]) -> None:
    (tmp_path / "masks.json").write_text('{"one.jpg": [{"id": 1}]}')
    (tmp_path / "one.png").write_bytes(png(*size))
    refuse(tmp_path, "cannot read the masks")


@pytest.mark.parametrize(
    ("entry", "said"),
    [
        ('"segmentation": {"size": [1e999, 3], "counts": "0"}', "size must be"),
        ('"segmentation": {"size": [12, 16], "counts": [192]}, "category_id": [1]', "cannot be read"),
        ('"segmentation": {"size": [12, 16], "counts": [192]}, "score": 1e999', "finite scores"),
        ('"segmentation": {"size": [16, 12], "counts": [192]}', "do not fit"),
        ('"segmentation": {"size": [120, 160], "counts": [192]}', "runs cover 192 pixels instead of 19200"),
    ],
)
def test_results_of_impossible_masks_say_so(tmp_path: Path, entry: str, said: str) -> None:
    (tmp_path / "found.json").write_text(f'[{{"image_id": "one", {entry}}}]')
    refuse(tmp_path, said)


def test_masks_beyond_memory_are_refused_before_they_are_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rle, "decode", lambda told: pytest.fail("a mask was read"))
    large = {"size": [12288, 16384], "counts": [12288 * 16384]}  # 0.2 GB a mask
    (tmp_path / "found.json").write_text(json.dumps([{"image_id": "one", "segmentation": large}] * 30))
    refuse(tmp_path, "make them smaller")


@pytest.mark.parametrize(
    "changes",
    [
        {"w": float("inf")}, {"w": 10**400}, {"w": 10**9}, {"w": float("nan")}, {"fl_x": 10**400}, {"cx": float("nan")},
        {"fl_x": None, "camera_angle_x": 0}, {"fl_x": None, "camera_angle_x": float("inf")}, {"frames": [[1]]},
        {"frames": [{"file_path": "a", "transform_matrix": [[10**400] * 4] * 4}]},
        {"frames": [{"file_path": "a", "transform_matrix": [[float("nan")] * 4] * 4}]},
        {"frames": [{"file_path": "a", "transform_matrix": [[1e300] * 4] * 4}]},
        {"frames": [{"file_path": None, "transform_matrix": np.eye(4).tolist()}]},
    ],
)  # fmt: skip
@pytest.mark.filterwarnings("ignore:overflow")
def test_a_capture_of_impossible_numbers_names_the_frame(tmp_path: Path, changes: dict[str, Any]) -> None:
    told = {"w": 16, "h": 12, "fl_x": 20.0, "frames": [{"file_path": "a", "transform_matrix": np.eye(4).tolist()}]}
    (tmp_path / "transforms.json").write_text(json.dumps({k: v for k, v in (told | changes).items() if v is not None}))
    with pytest.raises(FileError, match="frame 0"):
        read_capture(tmp_path)


# -- vectors


def in_archive(**columns: Any) -> Callable[[Path], str]:
    def write(folder: Path) -> str:
        (folder / "v.npz").write_bytes(held(**columns))
        return f"vectors:{folder}/v.npz"

    return write


def in_folder(name: str, content: str) -> Callable[[Path], str]:
    def write(folder: Path) -> str:
        np.save(folder / "text.npy", np.eye(2))
        (folder / "names.json").write_text('["a", "b"]')
        if name == "names.txt":
            (folder / "names.json").unlink()
        (folder / name).write_text(content)
        return f"vectors:{folder}"

    return write


@pytest.mark.parametrize(
    ("write", "said"),
    [
        (in_archive(names=np.array(["a", "b"]), text=np.array([["x"], ["y"]])), "numbers"),
        (in_archive(names=np.array(["a", None], dtype=object), text=np.eye(2)), "needs the arrays"),
        (in_archive(names=np.array("a"), text=np.eye(2)), "need as many"),
        (in_archive(names=np.array(["a", "b"]), text=np.full((2, 2), np.nan)), "not finite"),
        (in_folder("names.txt", ",\nb\n"), "must be a list"),
        (in_folder("names.json", '[{"name": "a", "synonyms": 3}, "b"]'), "must be a list"),
        (in_folder("names.json", '[{"name": "a", "synonyms": null}, "b"]'), "must be a list"),
        (in_folder("names.json", DEEP), "cannot be read"),
        (in_folder("calibration.json", "[]"), "is not a calibration"),
    ],
)
def test_vectors_that_do_not_hold_together_say_why(tmp_path: Path, write: Callable[[Path], str], said: str) -> None:
    with pytest.raises(BackendError, match=said):
        encoders.load(write(tmp_path))
