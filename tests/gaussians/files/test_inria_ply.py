"""The original splat .ply: laws of the round trip, and a slow reference that packs rows one by one."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from scenewright.gaussians import files
from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.errors import FileError
from scenewright.gaussians.scene import Frame, Scene

Row = dict[str, float]
reuse_folder = settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=40)


def names(degree: int) -> list[str]:
    """Properties in the original order."""
    rest = [f"f_rest_{i}" for i in range(3 * ((degree + 1) ** 2 - 1))]
    shape = ["opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"]
    return ["x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", *rest, *shape]


def random_rows(n: int, degree: int = 0, seed: int = 0) -> list[Row]:
    """Stored values that float32 holds exactly."""
    rng = np.random.default_rng(seed)
    return [{name: float(np.float32(rng.normal())) for name in names(degree)} for _ in range(n)]


def pack(rows: list[Row], order: list[str], encoding: str = "binary_little_endian", kind: str = "float") -> bytes:
    """Slow reference writer."""
    head = f"ply\nformat {encoding} 1.0\nelement vertex {len(rows)}\n"
    head += "".join(f"property {kind} {name}\n" for name in order) + "end_header\n"
    if encoding == "ascii":
        return (head + "".join(" ".join(repr(row[name]) for name in order) + "\n" for row in rows)).encode()
    code = ("<" if "little" in encoding else ">") + {"float": "f", "double": "d"}[kind]
    return head.encode() + b"".join(struct.pack(code, row[name]) for row in rows for name in order)


def put(folder: Path, content: bytes) -> Path:
    path = folder / "scene.ply"
    path.write_bytes(content)
    return path


def make_cloud(n: int, degree: int, seed: int) -> GaussianCloud:
    """Unusual but legal values: scales over 60 octaves, opacities up to both ends, quaternions of any length."""
    g = torch.Generator().manual_seed(seed)
    opacities = torch.cat([torch.rand(n, generator=g), torch.tensor([0.0, 1.0, 1e-30, 1 - 6e-8])])[-n:]
    return GaussianCloud.create(
        torch.randn(n, 3, generator=g) * 100,
        torch.randn(n, 4, generator=g),
        torch.exp(torch.randn(n, 3, generator=g) * 20),
        opacities,
        torch.randn(n, (degree + 1) ** 2, 3, generator=g),
    )


@reuse_folder
@given(st.integers(0, 3), st.integers(0, 2**31), st.integers(1, 300))
def test_writing_again_what_was_read_gives_the_same_bytes(tmp_path: Path, degree: int, seed: int, n: int) -> None:
    first, second = tmp_path / "first.ply", tmp_path / "second.ply"
    files.save(Scene(make_cloud(n, degree, seed)), first, force=True)
    once = files.load(first)
    files.save(once, second, force=True)
    assert first.read_bytes() == second.read_bytes()
    assert files.load(second).cloud.digest() == once.cloud.digest()


@reuse_folder
@given(st.integers(0, 3), st.integers(0, 2**31))
def test_a_cloud_comes_back(tmp_path: Path, degree: int, seed: int) -> None:
    cloud = make_cloud(20, degree, seed)
    files.save(Scene(cloud), tmp_path / "a.ply", force=True)
    back = files.load(tmp_path / "a.ply").cloud
    assert torch.equal(back.means, cloud.means) and torch.equal(back.sh, cloud.sh)
    assert back.ids.tolist() == list(range(20)) and back.degree == degree
    # A float32 logarithm of size 60 or logit of size 16 is good to 4e-6 or 1e-6, which is the relative error after exp.
    assert torch.allclose(back.scales, cloud.scales, rtol=4e-6, atol=0)
    assert torch.allclose(back.opacities, cloud.opacities, rtol=2e-6, atol=1e-7)
    assert torch.allclose(back.quats, torch.nn.functional.normalize(cloud.quats, dim=1), atol=2e-7)


def test_a_finite_world_of_opacities_survives_exactly() -> None:
    """The laws of second writes above depend on this: all float32 logits of opacities map back to themselves."""
    from scenewright.gaussians.files.formats import values

    rng = np.random.default_rng(0)
    bits = rng.integers(0, 0x3F800000, 400_000, dtype=np.uint32)  # every exponent from 0 to just below 1.0
    opacities = np.concatenate([bits.view(np.float32), 1 - bits[:100_000].view(np.float32)])
    logits = values.logits_from_opacities(opacities)
    assert np.array_equal(values.logits_from_opacities(values.opacities_from_logits(logits)), logits)
    scales = rng.integers(1, 0x7F800000, 400_000, dtype=np.uint32).view(np.float32)
    logs = values.logs_from_scales(scales)
    assert np.array_equal(values.logs_from_scales(values.scales_from_logs(logs)), logs)


@reuse_folder
@given(
    st.integers(0, 3),
    st.sampled_from(["binary_little_endian", "binary_big_endian", "ascii"]),
    st.sampled_from(["float", "double"]),
    st.randoms(use_true_random=False),
)
def test_order_encoding_and_type_do_not_matter(tmp_path: Path, degree: int, encoding: str, kind: str, rng: Any) -> None:
    rows = random_rows(7, degree)
    plain = files.load(put(tmp_path, pack(rows, names(degree)))).cloud
    order = names(degree)
    rng.shuffle(order)
    assert files.load(put(tmp_path, pack(rows, order, encoding, kind))).cloud.digest() == plain.digest()


def test_every_value_lands_where_it_belongs(tmp_path: Path) -> None:
    row = {name: 0.01 * i for i, name in enumerate(names(3))}
    cloud = files.load(put(tmp_path, pack([row], names(3)))).cloud
    f32 = {"rtol": 1e-6}  # one rounding to float32 each way
    assert np.allclose(cloud.means[0], [row["x"], row["y"], row["z"]], **f32)
    assert np.allclose(cloud.scales[0], np.exp([row[f"scale_{i}"] for i in range(3)]), **f32)
    assert np.allclose(cloud.opacities[0], 1 / (1 + np.exp(-row["opacity"])), **f32)
    quat = np.array([row[f"rot_{i}"] for i in range(4)])
    assert np.allclose(cloud.quats[0], quat / np.linalg.norm(quat), **f32)
    for channel in range(3):
        assert cloud.sh[0, 0, channel] == np.float32(row[f"f_dc_{channel}"])
        for band in range(15):  # all of red, then all of green, then all of blue
            assert cloud.sh[0, band + 1, channel] == np.float32(row[f"f_rest_{channel * 15 + band}"])


def test_other_elements_properties_and_line_ends_are_passed_over(tmp_path: Path) -> None:
    rows = random_rows(5)
    plain = files.load(put(tmp_path, pack(rows, names(0)))).cloud
    for row in rows:
        row["nx"] = 3.0
    content = pack(rows, ["nx", *names(0)])
    before = b"element camera 2\nproperty uchar a\nproperty short b\nelement vertex"
    content = content.replace(b"element vertex", before).replace(b"end_header\n", b"end_header\n" + b"\x01\x02\x03" * 2)
    content = content.replace(b"format", b"comment made by hand\nobj_info x\nformat")
    assert files.load(put(tmp_path, content)).cloud.digest() == plain.digest()
    head, body = content.split(b"end_header\n", 1)
    windows = head.replace(b"\n", b"\r\n") + b"end_header\r\n" + body
    assert files.load(put(tmp_path, windows)).cloud.digest() == plain.digest()


def test_faulty_rows_are_left_out_counted_and_ids_stay_row_numbers(tmp_path: Path) -> None:
    rows = random_rows(8)
    rows[1]["x"] = float("nan")
    rows[3]["scale_1"] = float("inf")
    rows[4]["f_dc_2"] = float("-inf")
    rows[5]["opacity"] = float("nan")
    for i in range(4):
        rows[6][f"rot_{i}"] = 0.0
    scene, report = files.load_with_report(put(tmp_path, pack(rows, names(0))))
    assert scene.cloud.ids.tolist() == [0, 2, 6, 7]
    assert scene.cloud.quats[2].tolist() == [1, 0, 0, 0]
    assert (report.rows, report.loaded) == (8, 4)
    assert report.notes == (
        "4 of 8 Gaussians were dropped: NaN or infinite values",
        "1 zero quaternions were replaced by the identity rotation",
    )


def test_full_opacity_and_flat_gaussians_are_sound(tmp_path: Path) -> None:
    """Converters write infinite logits for bytes 0 and 255, and minus infinity for the thickness of a disc."""
    rows = random_rows(3)
    rows[0]["opacity"], rows[1]["opacity"], rows[2]["scale_0"] = float("inf"), float("-inf"), float("-inf")
    scene, report = files.load_with_report(put(tmp_path, pack(rows, names(0))))
    assert report.notes == () and len(scene.cloud) == 3
    assert ((scene.cloud.opacities > 0) & (scene.cloud.opacities < 1)).all() and (scene.cloud.scales > 0).all()


def test_frame_and_cameras_come_back(tmp_path: Path) -> None:
    camera = Camera.look_at((0.1, 1 / 3, 2), (1, 0, 0), (0, 0, 1), 321, 123, 47.3, name='the "door"\n→ é')
    frame = Frame((0.1, 0.2, 0.9), -0.3, 1.7, up_source="given", scale_source="estimated")
    files.save(Scene(make_cloud(4, 1, 0), frame, (camera, camera)), tmp_path / "a.ply")
    back, report = files.load_with_report(tmp_path / "a.ply")
    assert report.notes == ()
    assert back.frame == frame.__class__(frame.up, -0.3, 1.7, up_source="file", scale_source="estimated")
    assert len(back.cameras) == 2 and back.cameras[0].name == camera.name
    assert np.array_equal(back.cameras[1].world_to_camera, camera.world_to_camera)
    fields = ("fx", "fy", "cx", "cy", "width", "height")
    assert all(getattr(back.cameras[0], f) == getattr(camera, f) for f in fields)
    files.save(back, tmp_path / "b.ply")
    assert (tmp_path / "a.ply").read_bytes() == (tmp_path / "b.ply").read_bytes()


def test_numbers_from_numpy_are_numbers_in_the_header(tmp_path: Path) -> None:
    side, focal = np.int64(64), np.float32(50)
    camera = Camera(np.eye(4), focal, focal, focal, focal, side, side)  # type: ignore[arg-type]
    files.save(Scene(make_cloud(4, 0, 0), Frame(floor=np.float32(0.5)), (camera,)), tmp_path / "a.ply")
    back = files.load(tmp_path / "a.ply")
    assert back.frame.floor == 0.5 and (back.cameras[0].width, back.cameras[0].fx) == (64, 50)


def test_the_third_line_is_the_vertex_count_whatever_the_comments(tmp_path: Path) -> None:
    """INRIA's own viewer reads the count there without looking."""
    camera = Camera.look_at((0, 0, 1), (1, 0, 0), (0, 0, 1))
    files.save(Scene(make_cloud(4, 0, 0), Frame(floor=0.0), (camera,)), tmp_path / "a.ply")
    lines = (tmp_path / "a.ply").read_bytes().split(b"\n")
    assert lines[:3] == [b"ply", b"format binary_little_endian 1.0", b"element vertex 4"]


def test_a_file_without_our_comments_has_an_unknown_frame(tmp_path: Path) -> None:
    scene = files.load(put(tmp_path, pack(random_rows(2), names(0))))
    assert scene.frame == Frame() and scene.frame.up_source == "unknown" and scene.cameras == ()
    assert scene.path == tmp_path / "scene.ply"


@pytest.mark.parametrize(
    "comment",
    ["frame {", "frame {}", 'frame {"up": [0, 0, 0]}', 'frame {"up": [0, 0, NaN]}', 'camera {"size": [0, 1]}', "frame"],
)
def test_unusable_comments_are_noted_and_ignored(tmp_path: Path, comment: str) -> None:
    content = pack(random_rows(2), names(0)).replace(
        b"end_header", f"comment scenewright {comment}\nend_header".encode()
    )
    scene, report = files.load_with_report(put(tmp_path, content))
    assert scene.frame == Frame() and len(report.notes) == 1 and "ignored" in report.notes[0]


def test_foreign_and_future_comments_are_ignored_silently(tmp_path: Path) -> None:
    extra = b"comment scenewright mood {}\ncomment scenewrights frame\ncomment\nend_header"
    _, report = files.load_with_report(put(tmp_path, pack(random_rows(2), names(0)).replace(b"end_header", extra)))
    assert report.notes == ()


GOOD = pack(random_rows(3), names(0))
BAD: dict[str, tuple[bytes, str]] = {
    "more rows promised than held": (GOOD.replace(b"vertex 3", b"vertex 4"), "declares 4 vertex rows.*at most 3"),
    "absurd count": (GOOD.replace(b"vertex 3", b"vertex 999999999999999999"), "declares"),
    "beyond 64 bits": (GOOD.replace(b"vertex 3", b"vertex " + b"9" * 30), "header line"),
    "negative count": (GOOD.replace(b"vertex 3", b"vertex -3"), "header line"),
    "zero rows": (GOOD.replace(b"vertex 3", b"vertex 0"), "zero Gaussians"),
    "cut in the header": (GOOD[:100], "end_header"),
    "cut in the body": (GOOD[:-1], "declares 3"),
    "empty": (b"", "not a PLY"),
    "no vertex": (GOOD.replace(b"element vertex", b"element point"), "no vertex"),
    "point cloud": (GOOD.replace(b"f_dc", b"dc").replace(b"scale", b"size"), "point cloud.*f_dc_0"),
    "one missing": (GOOD.replace(b"rot_3", b"rotx3"), "rot_3"),
    "wrong f_rest": (GOOD.replace(b"property float x", b"property float f_rest_0\nproperty float x"), "f_rest"),
    "twice": (GOOD.replace(b"property float y", b"property float x"), "twice"),
    "list": (GOOD.replace(b"property float x", b"property list uchar int x"), "list"),
    "unknown type": (GOOD.replace(b"property float x", b"property half x"), "header line"),
    "unknown encoding": (GOOD.replace(b"binary_little_endian", b"binary_middle_endian"), "header line"),
    "no encoding": (GOOD.replace(b"format binary_little_endian 1.0\n", b""), "format line"),
    "property before element": (GOOD.replace(b"element vertex 3\n", b""), "header line"),
    "ascii words": (pack(random_rows(1), names(0), "ascii").rsplit(b" ", 1)[0] + b" maybe\n", "not a number"),
    "ascii short": (pack(random_rows(3), names(0), "ascii").rsplit(b"\n", 2)[0] + b"\n0\n", "expected 3 lines"),
    "only NaN": (pack([dict.fromkeys(names(0), float("nan"))] * 2, names(0)), "none of its 2"),
}  # fmt: skip


@pytest.mark.parametrize("case", sorted(BAD))
def test_broken_files_are_refused_with_the_reason(tmp_path: Path, case: str) -> None:
    content, message = BAD[case]
    with pytest.raises(FileError, match=message):
        files.load(put(tmp_path, content))


def test_a_real_scene_matches_an_independent_reading(data_dir: Path, tmp_path: Path) -> None:
    path = data_dir / "scenes" / "bonsai_room.ply"
    scene, report = files.load_with_report(path)
    assert report.rows == report.loaded == 218_885 and report.notes == ()
    body = path.read_bytes().split(b"end_header\n", 1)[1]
    for row in (0, 100_000, 218_884):
        v = struct.unpack_from("<17f", body, row * 68)
        assert scene.cloud.means[row].tolist() == list(v[:3])
        assert scene.cloud.sh[row, 0].tolist() == list(v[6:9])
        assert np.allclose(scene.cloud.scales[row], np.exp(v[10:13]), rtol=1e-6)
    files.save(scene, tmp_path / "copy.ply")
    again = np.frombuffer((tmp_path / "copy.ply").read_bytes().split(b"end_header\n", 1)[1], "<f4").reshape(-1, 17)
    stored = np.frombuffer(body, "<f4").reshape(-1, 17)
    # Positions and colour are copied; logs are of size 10, and pass through float32 once.
    assert np.array_equal(again[:, :9], stored[:, :9])
    assert np.allclose(again[:, 10:13], stored[:, 10:13], atol=1e-5, rtol=0)
    # Logits beyond 16.6 are clamped, which changes an opacity by at most 2^-24.
    opacity = [1 / (1 + np.exp(-column[:, 9].astype(np.float64))) for column in (again, stored)]
    assert np.allclose(*opacity, atol=1.2e-7, rtol=0)
