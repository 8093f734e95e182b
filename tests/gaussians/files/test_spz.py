"""SPZ of every version against a slow reference that packs one Gaussian at a time by hand; broken files are refused."""

from __future__ import annotations

import gzip
import math
import struct
import tracemalloc
import zlib
from pathlib import Path

import numpy as np
import pytest
import torch
import zstandard
from hypothesis import given
from hypothesis import strategies as st

from scenewright.gaussians import files, harmonics
from scenewright.gaussians.errors import FileError
from scenewright.gaussians.files.formats import spz, spz_codes, zstd

DIMS = (0, 3, 8, 15, 24)


class Packed:
    """`n` Gaussians of random bytes, one attribute after the other, as a file of `version` holds them."""

    def __init__(self, version: int, n: int = 20, degree: int = 1, fraction: int = 12, seed: int = 0) -> None:
        rng = np.random.default_rng(seed)
        self.version, self.n, self.degree, self.fraction = version, n, degree, fraction
        widths = (6 if version == 1 else 9, 1, 3, 3, 3 if version < 3 else 4, 3 * DIMS[degree])
        self.streams = [rng.integers(0, 256, (n, width), dtype=np.uint8) for width in widths]
        if version == 1:  # half floats; any two bytes may be NaN
            self.streams[0] = rng.normal(size=(n, 3)).astype("<f2").view(np.uint8)
        elif version == 2:  # a unit quaternion's vector part is no longer than one
            vectors = rng.normal(size=(n, 3))
            vectors *= rng.uniform(0, 0.99, (n, 1)) / np.linalg.norm(vectors, axis=1, keepdims=True)
            self.streams[4] = np.round(vectors * 127.5 + 127.5).astype(np.uint8)
        else:  # three components of at most 1/√3 each
            words = np.zeros(n, "<u4")
            for _ in range(3):
                words = words << 10 | rng.integers(0, 2, n) << 9 | rng.integers(0, 400, n)
            self.streams[4] = (words | rng.integers(0, 4, n) << 30).astype("<u4")[:, None].view(np.uint8)

    def bytes(self, extension: bytes = b"") -> bytes:
        flags = 2 if extension else 0
        if self.version < 4:
            head = struct.pack("<4sIIBBBB", b"NGSP", self.version, self.n, self.degree, self.fraction, flags, 0)
            return gzip.compress(head + b"".join(s.tobytes() for s in self.streams), mtime=0)
        packed = [zstd.compress(s.tobytes()) for s in self.streams if s.size]
        head = struct.pack(
            "<4sIIBBBBI12x", b"NGSP", 4, self.n, self.degree, self.fraction, flags, len(packed), 32 + len(extension)
        )
        table = b"".join(struct.pack("<QQ", len(p), s.nbytes) for p, s in zip(packed, self.streams, strict=False))
        return head + extension + table + b"".join(packed)

    def gaussian(self, i: int) -> dict[str, list[float]]:
        """Slow reference: the i-th Gaussian in right-down-forward axes, straight from Niantic's description."""
        position, alpha, color, scale, rotation, rest = (stream[i].tobytes() for stream in self.streams)
        if self.version == 1:
            mean = list(struct.unpack("<eee", position))
        else:
            mean = [int.from_bytes(position[3 * a : 3 * a + 3], "little", signed=True) / 2**self.fraction
                    for a in range(3)]  # fmt: skip
        if self.version < 3:
            x, y, z = (c / 127.5 - 1 for c in rotation)
            quat = [x, y, z, math.sqrt(max(0.0, 1 - x * x - y * y - z * z))]
        else:
            word, quat = int.from_bytes(rotation, "little"), [0.0] * 4
            largest = word >> 30
            for axis in (3, 2, 1, 0):
                if axis != largest:
                    quat[axis] = (word & 511) / 511 / math.sqrt(2) * (-1 if word & 512 else 1)
                    word >>= 10
            quat[largest] = math.sqrt(1 - sum(c * c for c in quat))
        x, y, z, w = quat
        return {
            "mean": [mean[0], -mean[1], -mean[2]],
            "quat": [w, x, -y, -z],
            "scale": [math.exp(c / 16 - 10) for c in scale],
            "opacity": [min(max(alpha[0] / 255, 1e-9), 1.0)],
            "dc": [(c / 255 - 0.5) / 0.15 for c in color],
            "rest": [(c - 128) / 128 for c in rest],
        }


def put(folder: Path, content: bytes) -> Path:
    path = folder / "a.spz"
    path.write_bytes(content)
    return path


@pytest.mark.parametrize("version", [1, 2, 3, 4])
@pytest.mark.parametrize("degree", [0, 1, 2, 3])
def test_agrees_with_the_slow_reference(tmp_path: Path, version: int, degree: int) -> None:
    packed = Packed(version, degree=degree, fraction=9, seed=version)
    scene, report = files.load_with_report(put(tmp_path, packed.bytes()))
    cloud = scene.cloud
    assert report.format == f"Niantic SPZ {version}" and report.loaded == packed.n and report.notes == ()
    assert cloud.degree == degree
    # What the axes do to harmonics is known here only through our own rotation of harmonics, tested elsewhere.
    turn = torch.diag(torch.tensor([1.0, -1.0, -1.0]))
    tolerance = {"rtol": 2e-6, "atol": 2e-6}  # one rounding to float32 of values near one
    for i in range(packed.n):
        want = packed.gaussian(i)
        assert np.allclose(cloud.means[i], want["mean"], **tolerance)
        quat = np.array(want["quat"])
        assert np.allclose(cloud.quats[i], quat / np.linalg.norm(quat), **tolerance)
        assert np.allclose(cloud.scales[i], want["scale"], **tolerance)
        assert np.allclose(cloud.opacities[i], want["opacity"], **tolerance)
        assert np.allclose(cloud.sh[i, 0], want["dc"], **tolerance)
        sh = torch.tensor([want["dc"], *np.reshape(want["rest"], (-1, 3)).tolist()], dtype=torch.float32)
        assert np.allclose(cloud.sh[i], harmonics.rotate(sh[None], turn)[0], atol=1e-5)


@pytest.mark.parametrize("signs", sorted(set(spz._SYSTEMS.values())))
def test_axes_turn_harmonics_as_a_rotation_does(signs: spz_codes.Signs) -> None:
    packed = np.random.default_rng(1).integers(0, 256, (10, 45), dtype=np.uint8)
    plain = torch.from_numpy(spz_codes.harmonics(packed, (1, 1, 1)))
    sh = torch.cat([torch.zeros(10, 1, 3), plain], dim=1)
    turned = harmonics.rotate(sh, torch.diag(torch.tensor(signs, dtype=torch.float32)))
    assert np.allclose(spz_codes.harmonics(packed, signs), turned[:, 1:], atol=1e-5)


def axes(system: int) -> bytes:
    other = struct.pack("<II", 0x12340001, 5) + b"hello"
    return other + struct.pack("<III", 0xADBE0003, 4, system)


def test_the_axes_extension_is_obeyed(tmp_path: Path) -> None:
    packed = Packed(4)
    usual = files.load(put(tmp_path, packed.bytes())).cloud
    assert files.load(put(tmp_path, packed.bytes(axes(4)))).cloud.digest() == usual.digest()
    down = files.load(put(tmp_path, packed.bytes(axes(6)))).cloud
    assert torch.equal(down.means, usual.means * torch.tensor([1.0, -1.0, -1.0]))
    with pytest.raises(FileError, match="mirrored or turned"):
        files.load(put(tmp_path, packed.bytes(axes(8))))


def test_degree_four_is_cut_with_a_note(tmp_path: Path) -> None:
    scene, report = files.load_with_report(put(tmp_path, Packed(4, degree=4).bytes()))
    assert scene.cloud.degree == 3 and "degree 4" in report.notes[0]


def test_stored_frames_are_sound(tmp_path: Path) -> None:
    for size in (0, 1, 1000, 1 << 17, (1 << 17) + 1, 300_000):
        data = bytes(range(256)) * (size // 256 + 1)
        assert zstd.decompress(zstd.store(data[:size]), size) == data[:size]


@pytest.mark.parametrize("version", spz.WRITABLE)
def test_what_packs_too_well_is_stored_so_that_it_can_be_read(
    tmp_path: Path, version: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(spz, "FREE", 1000)
    scene = files.load(put(tmp_path, Packed(3, n=1, degree=2).bytes()))
    many = scene.replace(cloud=scene.cloud[torch.zeros(5000, dtype=torch.long)])
    with (tmp_path / "b.spz").open("wb") as file:
        spz.write(many, file, version)
    assert len(files.load(tmp_path / "b.spz").cloud) == 5000


def edited(version: int, offset: int, value: bytes) -> bytes:
    """A sound file with some of its header's bytes exchanged."""
    content = Packed(version).bytes()
    if version == 4:
        return content[:offset] + value + content[offset + len(value) :]
    plain = gzip.decompress(content)
    return gzip.compress(plain[:offset] + value + plain[offset + len(value) :], mtime=0)


GOOD3, GOOD4 = Packed(3).bytes(), Packed(4).bytes()
HUGE = struct.pack("<I", 2_000_000_000)
BAD: dict[str, tuple[bytes, str]] = {
    "cut gzip": (GOOD3[:-60], "cut off"),
    "cut checksum": (GOOD3[:-3], "cut off"),
    "wrong checksum": (GOOD3[:-8] + b"\0\0\0\0" + GOOD3[-4:], "damaged"),
    "header only": (gzip.compress(b"NGSP\x03\0\0\0"), "inside its header"),
    "other gzip": (gzip.compress(b"x" * 100), "not the gzip stream of an SPZ"),
    "gzip of version 9": (edited(3, 4, b"\x09"), "version 1 to 3"),
    "version 9": (edited(4, 4, b"\x09"), "version 9 is not known"),
    "degree": (edited(3, 12, b"\x05"), "degree 5"),
    "fraction": (edited(3, 13, b"\x30"), "48 fractional bits"),
    "no Gaussians": (edited(3, 8, b"\0"), "zero Gaussians"),
    "no Gaussians, 4": (edited(4, 8, b"\0"), "zero Gaussians"),
    "promise": (edited(3, 8, HUGE), "cannot be held"),
    "promise, 4": (edited(4, 8, HUGE), "cannot be held"),
    "small promise": (edited(3, 8, b"\xff"), "promises 255"),
    "table beyond": (edited(4, 16, HUGE), "table"),
    "too few streams": (edited(4, 15, b"\x02"), "table"),
    "too many streams": (edited(4, 15, b"\xff"), "table"),
    "stream beyond": (edited(4, 32, HUGE), "does not fit"),
    "stream size": (edited(4, 40, HUGE), "does not fit"),
    "broken stream": (GOOD4[:128] + bytes(4) + GOOD4[132:], "stream 0 .* damaged"),
    "cut stream": (GOOD4[:-1], "does not fit"),
    "only magic": (b"NGSP", "ends inside its header"),
}


@pytest.mark.parametrize("case", sorted(BAD))
def test_broken_files_are_refused_with_the_reason(tmp_path: Path, case: str) -> None:
    content, message = BAD[case]
    path = put(tmp_path, content)
    with pytest.raises(FileError, match=message):
        files.load(path)


def bomb_of_gzip(count: int) -> bytes:
    """A gzip stream of `count` Gaussians that are all zeros: 1,000 times smaller than what it unpacks to."""
    deflater = zlib.compressobj(9, zlib.DEFLATED, 31)
    head = deflater.compress(struct.pack("<4sIIBBBB", b"NGSP", 3, count, 0, 12, 0, 0))
    block = bytes(20 * 10_000)
    return head + b"".join(deflater.compress(block) for _ in range(count // 10_000)) + deflater.flush()


def bomb_of_zstd(count: int) -> bytes:
    packed = [zstd.compress(bytes(count * width)) for width in (9, 1, 3, 3, 4)]
    table = b"".join(struct.pack("<QQ", len(p), count * w) for p, w in zip(packed, (9, 1, 3, 3, 4), strict=True))
    return struct.pack("<4sIIBBBBI12x", b"NGSP", 4, count, 0, 12, 0, 5, 32) + table + b"".join(packed)


@pytest.mark.parametrize("bomb", [bomb_of_gzip, bomb_of_zstd])
def test_bombs_are_refused_before_they_go_off(tmp_path: Path, bomb: object) -> None:
    path = put(tmp_path, bomb(1_000_000))  # type: ignore[operator]
    tracemalloc.start()
    try:
        with pytest.raises(FileError, match="cannot be held"):
            files.load(path)
        assert tracemalloc.get_traced_memory()[1] < 10 * path.stat().st_size + 200_000  # the error's own words
    finally:
        tracemalloc.stop()


FRAME = zstd.compress(bytes(range(250)) * 4)
HOSTILE_FRAMES: dict[str, bytes] = {
    "empty": b"",
    "cut": FRAME[:-1],
    "cut header": FRAME[:5],
    "cut stored": zstd.store(bytes(1000))[:-1],
    "bytes after it": FRAME + b"\0",
    "two frames": zstd.store(bytes(500)) * 2,
    "another size": zstd.compress(bytes(999)),
    "a terabyte declared": zstd.store(b"")[:5] + struct.pack("<Q", 1 << 40) + zstd.store(b"")[13:],
    "less than declared": zstd.store(b"")[:5] + struct.pack("<Q", 1000) + zstd.store(bytes(10))[13:],
    "no size declared, too much": zstandard.ZstdCompressor(write_content_size=False).compress(bytes(100_000_000)),
    "no size declared, a window of 2 GiB": zstd.store(b"")[:4] + b"\0\xa8" + zstd.store(bytes(1000))[13:],
}


@pytest.mark.parametrize("case", sorted(HOSTILE_FRAMES))
def test_hostile_frames_are_refused_within_the_memory_of_the_expected_size(case: str) -> None:
    tracemalloc.start()
    try:
        with pytest.raises(zstd.BrokenFrameError):
            zstd.decompress(HOSTILE_FRAMES[case], 1000)
        assert tracemalloc.get_traced_memory()[1] < 20_000
    finally:
        tracemalloc.stop()


def test_a_frame_that_declares_no_size_is_read() -> None:
    frame = zstandard.ZstdCompressor(write_content_size=False).compress(bytes(1000))
    assert zstd.decompress(frame, 1000) == bytes(1000)


@given(st.binary(max_size=300))
def test_recognition_never_raises(head: bytes) -> None:
    for start in (b"", b"\x1f\x8b", b"\x1f\x8b\x08\0", b"NGSP"):
        assert spz.recognises(Path("a"), start + head) in (True, False)
