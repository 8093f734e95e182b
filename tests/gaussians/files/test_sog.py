"""SOG version 2 against a slow reference that decodes one Gaussian at a time, as a folder and as a zip."""

from __future__ import annotations

import io
import json
import math
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image, features

from scenewright.gaussians import files
from scenewright.gaussians.errors import FileError

Parts = dict[str, bytes]


def picture(pixels: np.ndarray, form: str = "WEBP") -> bytes:
    out = io.BytesIO()
    Image.fromarray(pixels).save(out, form, lossless=True, exact=True)
    return out.getvalue()


class Sog:
    """Random codes of `n` Gaussians, and the parts that hold them."""

    def __init__(self, n: int = 50, degree: int = 0, seed: int = 0) -> None:
        rng = np.random.default_rng(seed)
        self.n, self.k, self.side = n, (degree + 1) ** 2, math.ceil(math.sqrt(n)) + 1
        self.codes = {
            name: rng.integers(0, 256, (self.side, self.side, 4), dtype=np.uint8)
            for name in ("means_l", "means_u", "quats", "scales", "sh0", "shN_labels")
        }
        for name in ("means_l", "means_u", "scales"):
            self.codes[name][..., 3] = 255
        self.codes["quats"][..., 3] = rng.integers(252, 256, (self.side, self.side))
        self.sets = 70  # more than one row of 64
        labels = rng.integers(0, self.sets, (self.side, self.side))
        self.codes["shN_labels"] = np.stack([labels, labels * 0, labels * 0, labels * 0 + 255], axis=2).astype(np.uint8)
        self.palette = rng.integers(0, 256, (2, 64 * (self.k - 1), 3), dtype=np.uint8)
        self.books = {name: np.sort(rng.normal(size=256)).tolist() for name in ("scales", "sh0", "shN")}
        self.meta: dict[str, Any] = {
            "version": 2,
            "count": n,
            "means": {"mins": [-1, -2, 0.5], "maxs": [1, 3, 0.75], "files": ["means_l.webp", "means_u.webp"]},
            "scales": {"codebook": self.books["scales"], "files": ["scales.webp"]},
            "quats": {"files": ["quats.webp"]},
            "sh0": {"codebook": self.books["sh0"], "files": ["sh0.webp"]},
        }
        if degree:
            self.meta["shN"] = {
                "count": self.sets, "bands": degree, "codebook": self.books["shN"],
                "files": ["shN_centroids.webp", "shN_labels.webp"],
            }  # fmt: skip

    def parts(self) -> Parts:
        parts = {f"{name}.webp": picture(codes) for name, codes in self.codes.items()}
        if self.k > 1:
            parts["shN_centroids.webp"] = picture(self.palette)
        return {"meta.json": json.dumps(self.meta).encode(), **parts}

    def gaussian(self, i: int) -> dict[str, list[float]]:
        """Slow reference: the i-th Gaussian, straight from the specification."""
        y, x = divmod(i, self.side)
        code = {name: [int(v) for v in codes[y, x]] for name, codes in self.codes.items()}
        mean = []
        for axis in range(3):
            t = (code["means_u"][axis] << 8 | code["means_l"][axis]) / 65535
            low, high = self.meta["means"]["mins"][axis], self.meta["means"]["maxs"][axis]
            log = low + (high - low) * t
            mean.append(math.copysign(math.exp(abs(log)) - 1, log))
        quat = [(c / 255 * 2 - 1) / math.sqrt(2) for c in code["quats"][:3]]
        quat.insert(code["quats"][3] - 252, math.sqrt(max(0.0, 1 - sum(c * c for c in quat))))
        label = code["shN_labels"][0] + 256 * code["shN_labels"][1]
        row, column = divmod(label, 64)
        rest = [[self.books["shN"][c] for c in self.palette[row, column * (self.k - 1) + b]] for b in range(self.k - 1)]
        return {
            "mean": mean,
            "quat": quat,
            "scale": [math.exp(self.books["scales"][c]) for c in code["scales"][:3]],
            "dc": [self.books["sh0"][c] for c in code["sh0"][:3]],
            "opacity": [code["sh0"][3] / 255],
            "rest": [v for band in rest for v in band],
        }


def folder(root: Path, parts: Parts) -> Path:
    root.mkdir(exist_ok=True)
    for name, data in parts.items():
        (root / name).write_bytes(data)
    return root


def archive(path: Path, parts: Parts, method: int = zipfile.ZIP_STORED) -> Path:
    with zipfile.ZipFile(path, "w", method) as file:
        for name, data in parts.items():
            file.writestr(name, data)
    return path


@pytest.mark.parametrize("degree", [0, 1, 2, 3])
def test_agrees_with_the_slow_reference(tmp_path: Path, degree: int) -> None:
    sog = Sog(50, degree, seed=degree)
    cloud = files.load(folder(tmp_path / "s", sog.parts())).cloud
    assert len(cloud) == 50 and cloud.degree == degree and cloud.ids.tolist() == list(range(50))
    tolerance = {"rtol": 2e-6, "atol": 1e-6}  # one rounding to float32 of values near one, amplified by exp
    for i in range(50):
        want = sog.gaussian(i)
        assert np.allclose(cloud.means[i], want["mean"], **tolerance)
        quat = np.array(want["quat"])
        assert np.allclose(cloud.quats[i], quat / np.linalg.norm(quat), **tolerance)
        assert np.allclose(cloud.scales[i], want["scale"], **tolerance)
        assert np.allclose(cloud.opacities[i], np.clip(want["opacity"], 1e-7, 1), **tolerance)
        assert np.allclose(cloud.sh[i, 0], want["dc"], **tolerance)
        assert np.allclose(cloud.sh[i, 1:].ravel(), want["rest"], **tolerance)


def test_folder_meta_and_archive_are_the_same_scene(tmp_path: Path) -> None:
    parts = Sog(20, 1).parts()
    place = folder(tmp_path / "s", parts)
    digests = {files.load(p).cloud.digest() for p in (
        place, place / "meta.json", archive(tmp_path / "a.sog", parts),
        archive(tmp_path / "b.zip", parts, zipfile.ZIP_DEFLATED),
    )}  # fmt: skip
    assert len(digests) == 1


def test_pixels_without_a_rotation_are_repaired_and_counted(tmp_path: Path) -> None:
    sog = Sog(20)
    sog.codes["quats"][0, 1, 3] = 100
    scene, report = files.load_with_report(folder(tmp_path / "s", sog.parts()))
    assert scene.cloud.quats[1].tolist() == [1, 0, 0, 0] and "1 zero quaternion" in report.notes[0]


def changed(key: str, value: Any) -> Parts:
    """Parts whose meta.json has one entry exchanged, `key` with dots."""
    sog = Sog(20, 1)
    *path, last = key.split(".")
    place = sog.meta
    for step in path:
        place = place[step]
    place[last] = value
    return sog.parts()


BIG = [0.0] * 256
BAD: dict[str, tuple[Parts, str]] = {
    "malformed JSON": ({**Sog().parts(), "meta.json": b'{"version": 2,'}, "meta.json does not describe"),
    "nested JSON": ({**Sog().parts(), "meta.json": b"[" * 100_000}, "meta.json does not describe"),
    "binary JSON": ({**Sog().parts(), "meta.json": b"\xff\xfe\x00"}, "meta.json does not describe"),
    "version 1": (changed("version", 1), "version"),
    "zero rows": (changed("count", 0), "zero Gaussians"),
    "negative count": (changed("count", -1), "count"),
    "absurd count": (changed("count", 2**31), "do not fit into"),
    "too few pixels": (changed("count", 10_000), "pixels for 10,000"),
    "NaN bounds": (changed("means.mins", [0, 0, math.nan]), "meta.json does not describe"),
    "short codebook": (changed("scales.codebook", [0.0] * 3), "codebook of 3"),
    "empty codebook": (changed("sh0.codebook", []), "codebook"),
    "climbs out": (changed("quats.files", ["../../quats.webp"]), "quats.files"),
    "other drive": (changed("quats.files", ["c:quats.webp"]), "quats.files"),
    "absolute": (changed("quats.files", ["/etc/passwd"]), "quats.files"),
    "palette too long": (changed("shN.count", 1 << 17), "shN.count"),
    "palette too short": (changed("shN.count", 3), "beyond the palette of 3"),
    "palette without rows": (changed("shN.count", 10_000), "too small for 10,000"),
    "no bands": (changed("shN.bands", 4), "bands"),
    "not a picture": ({**Sog().parts(), "quats.webp": b"RIFF\x00\x00\x00\x00WEBPjunk"}, "quats.webp is not a readable"),
    "cut picture": ({**Sog().parts(), "sh0.webp": Sog().parts()["sh0.webp"][:-40]}, "sh0.webp is not a readable"),
    "too large picture": (
        {**Sog().parts(), "scales.webp": picture(np.zeros((400, 400, 4), np.uint8))}, "scales.webp is larger"
    ),
    "missing picture": ({k: v for k, v in Sog().parts().items() if k != "means_u.webp"}, "means_u.webp is missing"),
}  # fmt: skip


@pytest.mark.parametrize("zipped", [False, True])
@pytest.mark.parametrize("case", sorted(BAD))
def test_broken_scenes_are_refused_with_the_reason(tmp_path: Path, case: str, zipped: bool) -> None:
    parts, message = BAD[case]
    path = archive(tmp_path / "a.sog", parts) if zipped else folder(tmp_path / "a", parts)
    with pytest.raises(FileError, match=message):
        files.load(path)


def test_archives_that_are_not_sound(tmp_path: Path) -> None:
    whole = archive(tmp_path / "a.sog", Sog().parts(), zipfile.ZIP_DEFLATED).read_bytes()
    path = tmp_path / "b.sog"
    for content, message in (
        (whole[: len(whole) // 2], "not a valid zip"),
        (whole[:100] + bytes(200) + whole[300:], "valid zip|is missing|meta.json|readable"),
        (b"PK\x03\x04", "not a valid zip"),
    ):
        path.write_bytes(content)
        with pytest.raises(FileError, match=message):
            files.load(path)
    with pytest.raises(FileError, match=r"meta\.json is missing"):
        files.load(archive(tmp_path / "c.zip", {"readme.txt": b"hello"}))


def test_entries_that_inflate_are_refused_before_they_do(tmp_path: Path) -> None:
    parts = {**Sog().parts(), "meta.json": b" " * (17 << 20)}
    with pytest.raises(FileError, match=r"meta\.json is larger"):
        files.load(archive(tmp_path / "a.sog", parts, zipfile.ZIP_DEFLATED))
    parts = {**Sog().parts(), "quats.webp": bytes(5 << 20)}
    with pytest.raises(FileError, match=r"quats\.webp is larger"):
        files.load(archive(tmp_path / "b.sog", parts, zipfile.ZIP_DEFLATED))


def test_pillow_without_webp_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    place = folder(tmp_path / "s", Sog().parts())
    monkeypatch.setattr(features, "check", lambda feature: False)
    with pytest.raises(FileError, match="pip install"):
        files.load(place)


@pytest.mark.parametrize(("level", "count"), [("0_0", 500_000), ("2_0", 125_000)])
def test_the_real_robot(data_dir: Path, level: str, count: int) -> None:
    scene, report = files.load_with_report(data_dir / "scenes" / "playbot" / level)
    assert report.rows == report.loaded == count and report.notes == () and scene.cloud.degree == 2
    meta = json.loads((data_dir / "scenes" / "playbot" / level / "meta.json").read_text())
    low, high = (np.sign(v) * np.expm1(np.abs(v)) for v in (np.array(meta["means"][k]) for k in ("mins", "maxs")))
    means = scene.cloud.means.numpy()
    assert np.allclose(means.min(0), low, atol=1e-3) and np.allclose(means.max(0), high, atol=1e-3)
    assert np.allclose(scene.cloud.quats.norm(dim=1), 1, atol=1e-6)
