"""PlayCanvas' compressed .ply against a slow reference that unpacks one Gaussian at a time, bit by bit."""

from __future__ import annotations

import math
import struct
from pathlib import Path

import numpy as np
import pytest

from scenewright.gaussians import files
from scenewright.gaussians.errors import FileError

BOUNDS = [f"{end}_{group}{axis}" for group in ("", "scale_") for end in ("min", "max") for axis in "xyz"]
COLORS = [f"{end}_{c}" for end in ("min", "max") for c in "rgb"]
PACKED = ["packed_position", "packed_rotation", "packed_scale", "packed_color"]


class Packed:
    """A random packed scene of `n` Gaussians."""

    def __init__(self, n: int, degree: int = 0, colors: bool = True, seed: int = 0) -> None:
        rng = np.random.default_rng(seed)
        self.n, self.k = n, (degree + 1) ** 2
        self.names = BOUNDS + (COLORS if colors else [])
        self.chunks = [
            {name: float(np.float32(rng.uniform(-2, 0) if "min" in name else rng.uniform(0, 2))) for name in self.names}
            for _ in range(-(-n // 256))
        ]
        self.words = rng.integers(0, 1 << 32, (n, 4), dtype=np.uint32)
        self.rest = rng.integers(0, 256, (n, 3 * (self.k - 1)), dtype=np.uint8)

    def bytes(self, encoding: str = "binary_little_endian", order: list[str] = PACKED) -> bytes:
        e = "<" if "little" in encoding else ">"
        head = f"ply\nformat {encoding} 1.0\nelement chunk {len(self.chunks)}\n"
        head += "".join(f"property float {n}\n" for n in self.names)
        head += f"element vertex {self.n}\n" + "".join(f"property uint {n}\n" for n in order)
        if self.k > 1:
            head += f"element sh {self.n}\n"
            head += "".join(f"property uchar f_rest_{i}\n" for i in range(self.rest.shape[1]))
        body = b"".join(struct.pack(e + "f", c[n]) for c in self.chunks for n in self.names)
        body += b"".join(struct.pack(e + "I", int(w[PACKED.index(n)])) for w in self.words for n in order)
        return head.encode() + b"end_header\n" + body + self.rest.tobytes()

    def gaussian(self, i: int) -> dict[str, list[float]]:
        """Slow reference: the i-th Gaussian, straight from the description of the format."""
        chunk = self.chunks[i // 256]
        position, rotation, scale, color = (int(w) for w in self.words[i])

        def between(name: str, t: float) -> float:
            low, high = chunk.get(f"min_{name}", 0.0), chunk.get(f"max_{name}", 1.0)
            return low + (high - low) * t

        def split(word: int) -> list[float]:
            return [(word >> 21) / 2047, (word >> 11 & 1023) / 1023, (word & 2047) / 2047]

        quat = [((rotation >> shift & 1023) / 1023 - 0.5) * math.sqrt(2) for shift in (20, 10, 0)]
        quat.insert(rotation >> 30, math.sqrt(max(0.0, 1 - sum(c * c for c in quat))))
        rgb = [between(c, (color >> shift & 255) / 255) for c, shift in zip("rgb", (24, 16, 8), strict=True)]
        ends = {0: 0.0, 255: 1.0}
        rest = [(ends.get(int(b), (int(b) + 0.5) / 256) - 0.5) * 8 for b in self.rest[i]]
        return {
            "mean": [between(a, t) for a, t in zip("xyz", split(position), strict=True)],
            "quat": quat,
            "scale": [math.exp(between(f"scale_{a}", t)) for a, t in zip("xyz", split(scale), strict=True)],
            "opacity": [(color & 255) / 255],
            "dc": [(c - 0.5) / 0.28209479177387814 for c in rgb],
            "rest": [rest[c * (self.k - 1) + b] for b in range(self.k - 1) for c in range(3)],
        }


def put(folder: Path, content: bytes) -> Path:
    path = folder / "a.compressed.ply"
    path.write_bytes(content)
    return path


@pytest.mark.parametrize("degree", [0, 1, 2, 3])
@pytest.mark.parametrize("colors", [True, False])
@pytest.mark.parametrize("encoding", ["binary_little_endian", "binary_big_endian"])
def test_agrees_with_the_slow_reference(tmp_path: Path, degree: int, colors: bool, encoding: str) -> None:
    packed = Packed(300, degree, colors, seed=degree)
    cloud = files.load(put(tmp_path, packed.bytes(encoding))).cloud
    assert len(cloud) == 300 and cloud.degree == degree
    tolerance = {"rtol": 1e-6, "atol": 1e-6}  # one rounding to float32 of values near one
    for i in (0, 1, 17, 255, 256, 299):
        want = packed.gaussian(i)
        assert np.allclose(cloud.means[i], want["mean"], **tolerance)
        quat = np.array(want["quat"])
        assert np.allclose(cloud.quats[i], quat / np.linalg.norm(quat), **tolerance)
        assert np.allclose(cloud.scales[i], want["scale"], **tolerance)
        assert np.allclose(cloud.opacities[i], want["opacity"], **tolerance)
        assert np.allclose(cloud.sh[i, 0], want["dc"], **tolerance)
        assert np.allclose(cloud.sh[i, 1:].ravel(), want["rest"], **tolerance)


def test_order_of_properties_does_not_matter(tmp_path: Path) -> None:
    packed = Packed(10)
    plain = files.load(put(tmp_path, packed.bytes())).cloud.digest()
    assert files.load(put(tmp_path, packed.bytes(order=PACKED[::-1]))).cloud.digest() == plain


def test_ends_of_opacity_stay_inside(tmp_path: Path) -> None:
    packed = Packed(2)
    packed.words[0, 3] |= 255
    packed.words[1, 3] &= ~np.uint32(255)
    opacities = files.load(put(tmp_path, packed.bytes())).cloud.opacities
    assert 0 < opacities[1] < opacities[0] < 1


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(("bound", "value"), [("max_x", math.nan), ("min_r", 3e38), ("max_scale_y", 3e38)])
def test_chunks_with_absurd_bounds_cost_only_their_rows(tmp_path: Path, bound: str, value: float) -> None:
    packed = Packed(300)
    packed.words[256:] |= 0x00100001  # far enough from the other bound
    packed.words[256:, 3] &= 0x7FFFFFFF
    packed.chunks[1][bound] = value
    scene, report = files.load_with_report(put(tmp_path, packed.bytes()))
    assert scene.cloud.ids.tolist() == list(range(256)) and "44 of 300" in report.notes[0]


GOOD, SH = Packed(3).bytes(), Packed(3, 1).bytes()
BAD: dict[str, tuple[bytes, str]] = {
    "cut": (GOOD[:-1], "declares 3 vertex"),
    "too many rows": (GOOD.replace(b"vertex 3", b"vertex 3000000000000"), "chunks cannot describe"),
    "too many of both": (
        GOOD.replace(b"vertex 3", b"vertex 25600000000").replace(b"chunk 1", b"chunk 100000000"), "declares"
    ),
    "no rows": (GOOD.replace(b"vertex 3", b"vertex 0"), "zero Gaussians"),
    "few chunks": (GOOD.replace(b"chunk 1", b"chunk 0"), "0 chunks cannot describe 3"),
    "no chunk": (GOOD.replace(b"element chunk", b"element chunky"), "needs the elements"),
    "no bounds": (GOOD.replace(b"min_scale_z", b"min_scale_q"), "lacks min_scale_z"),
    "no rotation": (GOOD.replace(b"packed_rotation", b"packed_rotatiom"), "lacks packed_rotation"),
    "floats": (GOOD.replace(b"uint packed_scale", b"float packed_scale"), "32-bit"),
    "sh count": (SH.replace(b"element sh 3", b"element sh 2"), "sh element"),
    "sh properties": (SH.replace(b"f_rest_8", b"f_rest_9"), "sh element"),
}  # fmt: skip


@pytest.mark.parametrize("case", sorted(BAD))
def test_broken_files_are_refused_with_the_reason(tmp_path: Path, case: str) -> None:
    content, message = BAD[case]
    with pytest.raises(FileError, match=message):
        files.load(put(tmp_path, content))


def test_the_real_guitar(data_dir: Path) -> None:
    scene, report = files.load_with_report(data_dir / "scenes" / "guitar.compressed.ply")
    assert report.rows == report.loaded == 90_854 and report.notes == ()
    cloud = scene.cloud
    # A guitar on a stand: about as tall as a guitar, thinner than wide, mostly of warm wood.
    extent = np.quantile(cloud.means.numpy(), 0.95, axis=0) - np.quantile(cloud.means.numpy(), 0.05, axis=0)
    assert extent.argmax() == 1 and extent[1] > 2 * extent[[0, 2]].max()
    red, _, blue = (cloud.sh[:, 0] * 0.28209 + 0.5).mean(0).tolist()
    assert red > blue
    assert np.allclose(cloud.quats.norm(dim=1), 1, atol=1e-6)
