"""`scenewright fit` on captures that are broken, lie, or were exported otherwise; on full disks; and killed on the way.

Every refusal names what is wrong and leaves nothing behind.
"""

from __future__ import annotations

import io
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from PIL import Image

from scenewright.agent import cli
from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.errors import FileError
from scenewright.gaussians.files.captures.image_file import read_photo
from scenewright.gaussians.fit import checkpoint, load_photos
from scenewright.gaussians.harmonics import color_to_dc
from scenewright.gaussians.render import render

W, H, FOCAL = 56, 44, 60.0
POINTS = "sparse/0/points3D.txt"
Told = dict[str, Any]
Call = Callable[..., tuple[int, str]]
Turn = Callable[[NDArray[np.float64]], NDArray[np.float64]]


@pytest.fixture(scope="module")
def whole() -> tuple[list[NDArray[np.uint8]], Told, str]:
    """Twelve pictures of a shell of blobs, what transforms.json says of them, and the blobs as a survey has them."""
    rng = np.random.default_rng(3)
    means = rng.normal(size=(400, 3))
    means *= [1.0, 0.8, 0.6] / np.linalg.norm(means, axis=1, keepdims=True)
    colors = rng.uniform(0.05, 0.95, (400, 3))
    upright, dc = torch.tensor([[1.0, 0, 0, 0]]).repeat(400, 1), color_to_dc(torch.from_numpy(colors).float())
    cloud = GaussianCloud.create(
        torch.from_numpy(means).float(), upright, torch.full((400, 3), 0.06), torch.full((400,), 0.95), dc[:, None]
    )
    pictures, frames = [], []
    for i, angle in enumerate(np.linspace(0, 2 * np.pi, 12, endpoint=False)):
        eye = (3 * np.cos(angle), 3 * np.sin(angle), 0.9 + 0.5 * np.sin(3 * angle))
        seen = Camera.look_at(eye, (0, 0, 0), (0, 0, 1), W, H)
        camera = Camera(seen.world_to_camera, FOCAL, FOCAL, W / 2, H / 2, W, H)
        pictures.append(render(cloud, camera).to_uint8())
        pose = np.linalg.inv(camera.world_to_camera) @ np.diag([1.0, -1.0, -1.0, 1.0])
        frames.append({"file_path": f"images/p{i:02d}.png", "transform_matrix": pose.tolist()})
    told = {"fl_x": FOCAL, "fl_y": FOCAL, "cx": W / 2, "cy": H / 2, "w": W, "h": H, "frames": frames}
    surveyed = [
        " ".join(map(str, (i, *m, *(255 * c).astype(int), 0.5)))
        for i, (m, c) in enumerate(zip(means, colors, strict=True))
    ]
    return pictures, told, "\n".join(surveyed) + "\n"


@pytest.fixture
def capture(tmp_path: Path, whole: tuple[list[NDArray[np.uint8]], Told, str]) -> Path:
    pictures, told, points = whole
    folder = tmp_path / "capture"
    (folder / "images").mkdir(parents=True)
    (folder / "sparse/0").mkdir(parents=True)
    for i, picture in enumerate(pictures):
        Image.fromarray(picture).save(folder / "images" / f"p{i:02d}.png")
    (folder / "transforms.json").write_text(json.dumps(told))
    (folder / "sparse/0/cameras.txt").write_text(f"1 PINHOLE {W} {H} {FOCAL} {FOCAL} {W / 2} {H / 2}\n")
    (folder / POINTS).write_text(points)
    return folder


def changed(capture: Path, change: Callable[[Told], object]) -> None:
    path = capture / "transforms.json"
    told = json.loads(path.read_text())
    change(told)
    path.write_text(json.dumps(told))


def posed(
    turn: Callable[[NDArray[np.float64]], NDArray[np.float64]], only: int | None = None
) -> Callable[[Told], None]:
    def change(told: Told) -> None:
        for i, frame in enumerate(told["frames"]):
            if only in (None, i):
                frame["transform_matrix"] = turn(np.array(frame["transform_matrix"])).tolist()

    return change


@pytest.fixture
def call(capture: Path, capfd: pytest.CaptureFixture[str]) -> Call:
    """The command line on the capture, four steps long: its exit code and what it said; no picture of a scene stays."""

    def run(
        *arguments: object, output: Path = capture.parent / "out" / "scene.ply", made: bool = True
    ) -> tuple[int, str]:
        if made:
            output.parent.mkdir(exist_ok=True)
        with pytest.raises(SystemExit) as end:
            cli.main(["fit", str(capture), "-o", str(output), "--steps", "4", "--sh-degree", "0", *map(str, arguments)])
        said = capfd.readouterr().err
        assert isinstance(end.value.code, int) and "internal error" not in said and "Warning" not in said
        if end.value.code and made:
            assert not list(output.parent.iterdir())
        return end.value.code, said

    return run


def test_the_capture_itself_is_without_fault(call: Call) -> None:
    code, said = call()
    assert code == 0 and "400 surveyed points" in said and "warning" not in said


AXES = np.diag([1.0, -1.0, -1.0, 1.0])
ASIDE = np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])
WRONG: dict[str, tuple[Callable[[Told], object], str]] = {
    "a missing photograph": (lambda t: t["frames"][2].update(file_path="images/gone.png"), "gone.png is missing"),
    "an endless name": (lambda t: t["frames"][2].update(file_path="a" * 5000), "is missing; restore it"),
    "a device": (lambda t: t["frames"][2].update(file_path="/dev/zero"), "/dev/zero is missing"),
    "a file that is no picture": (lambda t: t["frames"][2].update(file_path="/etc/passwd"), "it is not a PNG, JPEG"),
    "one photograph twice": (lambda t: t["frames"].append(t["frames"][3]), "p03.png; remove one of them"),
    "no frames": (lambda t: t.update(frames=[]), "lists no frames"),
    "a frame that is none": (lambda t: t["frames"].__setitem__(1, None), "frame 1 is invalid: it is not an object"),
    "OpenCV axes": (posed(lambda m: m @ AXES), "its poses are in OpenCV axes"),
    "one pose in OpenCV axes": (posed(lambda m: m @ AXES, only=5), "p05 see none of the surveyed points"),
    "three poses in OpenCV axes": (
        lambda t: [posed(lambda m: m @ AXES, only=i)(t) for i in (1, 4, 5)], "3 of 12 cameras see none"),
    "world to camera": (posed(np.linalg.inv), "poses and points are in different frames"),
    "transposed poses": (posed(np.transpose), "not 0 0 0 1; it may be transposed"),
    "mirrored poses": (posed(lambda m: m @ np.diag([-1.0, 1, 1, 1])), "mirrors; export right-handed axes"),
    "scaled poses": (posed(lambda m: m @ np.diag([2.0, 2, 2, 1])), "scales by 2; divide"),
    "skewed poses": (posed(lambda m: m @ np.diag([2.0, 1, 1, 1])), "are not a rotation"),
    "NaN in a pose": (posed(lambda m: m * np.nan, only=4), "frame 4 is invalid: transform_matrix is not 4x4 finite"),
    "a pose beyond all measure": (posed(lambda m: m * 1e300, only=4), "frame 4 is invalid"),
    "a half pose": (posed(lambda m: m[:2], only=4), "is not 4x4 finite numbers"),
    "cameras in one place": (posed(lambda m: np.block([[m[:3, :3], np.zeros((3, 1))], [m[3:]]])), "stand in one place"),
    "no focal length": (lambda t: (t.pop("fl_x"), t.pop("fl_y")), "neither fl_x nor camera_angle_x"),
    "a focal length below zero": (lambda t: t.update(fl_x=-60), "positive size and focal lengths"),
    "a focal length of words": (lambda t: t.update(fl_x="long"), "fl_x must be a number, not 'long'"),
    "a focal length of a yes": (lambda t: t.update(fl_y=True), "fl_y must be a number, not True"),
    "a focal length of no lens": (lambda t: t.update(fl_x=1e-6), "pixels is implausible for an image of"),
    "focal lengths of photographs twice as large": (lambda t: t.update(fl_x=120, fl_y=120), "are 0.5 times as long"),
    "focal lengths of photographs half as large": (lambda t: t.update(fl_x=30, fl_y=30), "are 2 times as long"),
    "all intrinsics but the size twice as large": (
        lambda t: t.update({k: 2 * t[k] for k in ("fl_x", "fl_y", "cx", "cy")}), "is not inside the image of 56x44"),
    "another shape": (lambda t: t.update(w=H, h=W, cx=H / 2, cy=W / 2), "is 56x44, its camera says 44x56"),
    "an angle in degrees": (
        lambda t: (t.pop("fl_x"), t.pop("fl_y"), t.update(camera_angle_x=50)), "between 0 and pi (radians), got 50"),
    "a principal point elsewhere": (lambda t: t.update(cx=500), "its principal point 500, 22 is not inside"),
    "a size of none": (lambda t: t.update(w=float("inf")), "the size infx44 must lie between 1 and"),
    "a lens that folds": (lambda t: t.update(k1=-6), "folds the image"),
    "a lens beyond all measure": (lambda t: t.update(k1=1e200), "folds the image or maps it outside"),
    "a fisheye": (lambda t: t.update(is_fisheye=True), "undistort the photographs first"),
    "a lens of more numbers": (lambda t: t.update(k4=0.1), "have a k4; undistort the photographs first"),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_what_is_wrong_with_transforms_is_said(capture: Path, call: Call, name: str) -> None:
    change, told = WRONG[name]
    changed(capture, change)
    code, said = call("--strict")
    assert code == 4 and told in said and said.count("\n") == 1


def test_photographs_that_are_listed_and_not_there_are_left_out_and_told(capture: Path, call: Call) -> None:
    (capture / "images/p02.png").unlink()
    changed(capture, lambda told: told["frames"][5].update(file_path="images/\x1b[31m" + "a" * 5000))
    code, said = call()
    assert code == 0 and "warning: 2 photographs are listed, but not there, and are left out: p02.png" in said
    assert "\x1b" not in said and len(said) < 2000
    changed(capture, lambda told: [f.update(file_path=f"elsewhere/{i}.png") for i, f in enumerate(told["frames"])])
    (capture.parent / "out/scene.ply").unlink()
    code, said = call()
    assert code == 4 and "none of the" in said and "is there; the first is" in said


@pytest.mark.parametrize("body", [b"", b"hello", b'{"frames": [', bytes(range(256)), b"[1, 2]", b"[" * 100_000])
def test_transforms_that_are_no_json_are_refused(capture: Path, call: Call, body: bytes) -> None:
    (capture / "transforms.json").write_bytes(body)
    code, said = call()
    assert code == 4 and ("is not valid JSON" in said or "lists no frames" in said)


def test_what_would_steer_a_terminal_is_left_out(capture: Path, call: Call) -> None:
    changed(capture, lambda told: told["frames"][2].update(file_path="images/\x1b[31m\x9bred.png"))
    code, said = call("--strict")
    assert code == 4 and "[31mred.png is missing" in said and "\x1b" not in said and "\x9b" not in said


def test_poses_that_no_frame_check_can_fault_are_doubted_by_colour(capture: Path, call: Call) -> None:
    """A world turned on its side still has its cameras around its points; only the colours tell."""
    changed(capture, posed(lambda m: ASIDE @ m))
    code, said = call()
    assert code == 0 and "warning: surveyed points do not fall onto pixels of their colour" in said


# -- exported otherwise, but right --------------------------------------------------------------------------------


def suffixes_left_out(told: Told) -> None:
    for frame in told["frames"]:
        frame["file_path"] = "./" + frame["file_path"].removesuffix(".png")


def written_on_windows(told: Told) -> None:
    for frame in told["frames"]:
        frame["file_path"] = frame["file_path"].replace("/", "\\")


def by_angle_and_without_size(told: Told) -> None:
    for key in ("fl_x", "fl_y", "cx", "cy", "w", "h"):
        del told[key]
    told["camera_angle_x"] = 2 * np.arctan(W / 2 / FOCAL)


@pytest.mark.parametrize(
    "change",
    [suffixes_left_out, written_on_windows, by_angle_and_without_size, posed(lambda m: np.round(m, 3)),
     posed(lambda m: m[:3])],
)  # fmt: skip
def test_other_ways_of_saying_the_same_are_read(capture: Path, change: Callable[[Told], None]) -> None:
    before = load_photos(capture)
    changed(capture, change)
    after = load_photos(capture)
    assert [s.camera.name for s in before.shots] == [s.camera.name for s in after.shots]
    for a, b in zip(before.shots, after.shots, strict=True):
        assert np.array_equal(a.photo, b.photo) and a.camera.fx == pytest.approx(b.camera.fx)
        assert np.allclose(a.camera.world_to_camera, b.camera.world_to_camera, atol=3e-3)  # three digits, at 3 units


def test_a_byte_order_mark_is_no_part_of_the_text(capture: Path) -> None:
    path = capture / "transforms.json"
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes())
    assert len(load_photos(capture).shots) == 10


def test_rigs_may_number_the_photographs_of_each_camera(capture: Path) -> None:
    def moved(told: Told) -> None:
        for i, frame in enumerate(told["frames"]):
            name = f"images/{'left' if i % 2 else 'right'}/{i // 2:02d}.png"
            (capture / name).parent.mkdir(exist_ok=True)
            (capture / frame["file_path"]).rename(capture / name)
            frame["file_path"] = name

    changed(capture, moved)
    taken = load_photos(capture)
    names = [s.camera.name for s in (*taken.shots, *taken.held_out)]
    assert len(set(names)) == 12 and "left-03" in names and all("/" not in name for name in names)


# -- photographs ----------------------------------------------------------------------------------------------------


def taken(capture: Path, index: int = 1) -> NDArray[np.uint8]:
    """The second photograph as it would be learnt from."""
    return next(s.photo for s in load_photos(capture).shots if s.camera.name == f"p{index:02d}")


def test_photographs_of_any_kind_are_read_as_what_they_show(capture: Path) -> None:
    path = capture / "images/p01.png"
    shown = taken(capture)
    grey = np.asarray(Image.fromarray(shown).convert("L"))
    Image.fromarray(grey).save(path)
    assert np.array_equal(taken(capture), np.repeat(grey[..., None], 3, axis=2))
    Image.fromarray(grey.astype(np.uint16) * 257).save(path)
    assert np.array_equal(taken(capture), np.repeat(grey[..., None], 3, axis=2))
    alpha = np.tile(np.linspace(0, 255, W).astype(np.uint8), (H, 1))
    Image.fromarray(np.dstack([shown, alpha])).save(path)
    over_black = shown * (alpha[..., None] / 255)
    assert np.abs(taken(capture) - over_black).max() <= 0.5 + 1e-4
    Image.fromarray(shown).convert("CMYK").save(path, format="TIFF")
    assert np.abs(taken(capture).astype(int) - shown).max() <= 1


def test_a_quarter_turn_that_the_file_asks_for_is_made_where_the_camera_says_so(capture: Path) -> None:
    shown, exif = taken(capture), Image.Exif()
    exif[0x0112] = 6  # shown turned by a quarter to the right
    Image.fromarray(np.rot90(shown)).save(capture / "images/p01.png", exif=exif)
    assert np.array_equal(taken(capture), shown)


@pytest.mark.parametrize(
    ("save", "told"),
    [
        (lambda path: path.write_bytes(b""), "it is not a PNG, JPEG or other known image"),
        (lambda path: path.write_bytes(path.read_bytes()[:900]), "p03.png: image file is truncated"),
        (lambda path: Image.new("RGB", (44, 44)).save(path), "is 44x44, its camera says 56x44"),
        (lambda path: Image.new("RGB", (1, 1)).save(path), "is 1x1 pixels, too few to train on"),
        (lambda path: Image.new("F", (W, H)).save(path, "TIFF"), "it has floating-point pixels"),
        (lambda path: (path.unlink(), os.mkfifo(path)), "p03.png is missing"),
    ],
)
def test_a_broken_photograph_is_named(capture: Path, call: Call, save: Callable[[Path], object], told: str) -> None:
    save(capture / "images/p03.png")
    code, said = call("--strict")
    assert code == 4 and told in said and "p03.png" in said


@settings(max_examples=150, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    st.sampled_from(["PNG", "JPEG", "TIFF", "WEBP", "GIF", "BMP"]), st.floats(0, 1, exclude_max=True),
    st.integers(0, 255), st.booleans(),
)  # fmt: skip
def test_pictures_broken_anywhere_are_photographs_or_file_errors(
    tmp_path: Path, kind: str, place: float, byte: int, cut: bool
) -> None:
    path, written = tmp_path / "p", io.BytesIO()
    Image.fromarray(np.arange(24 * 20 * 3, dtype=np.uint8).reshape(20, 24, 3)).save(written, kind)
    whole = bytearray(written.getvalue())
    at = int(len(whole) * place**3)  # headers rather than pixels
    whole[at] = byte
    path.write_bytes(whole[:at] if cut else whole)
    try:
        photo = read_photo(path, (24, 20))
        assert photo.dtype == np.uint8 and photo.ndim == 3 and photo.shape[2] == 3
    except FileError as error:
        assert str(path) in str(error)


def test_photographs_of_nothing_are_refused(capture: Path, call: Call) -> None:
    for path in (capture / "images").iterdir():
        Image.new("RGB", (W, H), (0, 90, 0)).save(path)
    code, said = call()
    assert code == 4 and "is of one plain colour; there is nothing to train on" in said


# -- points ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("points", "told"),
    [
        (
            "",
            "no surveyed points, so poses cannot be checked; too few for initialization, "
            "so Gaussians start at random positions",
        ),
        ("1 nan nan nan 1 2 3 0.5\n" * 300, "no surveyed points"),
        ("1 0.1 0.1 0.1 1 2 3 0.5\n" * 20, "20 surveyed points; too few for initialization"),
    ],
)
def test_a_poor_survey_is_said_and_gone_on_without(capture: Path, call: Call, points: str, told: str) -> None:
    (capture / POINTS).write_text(points)
    code, said = call()
    assert code == 0 and told in said


def test_points_beyond_all_measure_are_no_start(capture: Path, call: Call, tmp_path: Path) -> None:
    from scenewright.gaussians.files import load

    with open(capture / POINTS, "a") as file:
        file.write("998 1e300 0 0 1 2 3 0.5\n999 1e30 1e30 1e30 1 2 3 0.5\n")
    assert call()[0] == 0
    cloud = load(tmp_path / "out/scene.ply").cloud
    assert len(cloud) == 400 and float(cloud.means.abs().max()) < 10


@pytest.mark.parametrize(
    ("file", "body", "told"),
    [
        (POINTS, "these are no points at all, really", "could not convert"),
        (POINTS, None, "has no points3D.bin or points3D.txt"),
        ("sparse/0/points3D.bin", "\xff" * 40, "is cut short"),
    ],
)
def test_a_broken_survey_is_refused(capture: Path, call: Call, file: str, body: str | None, told: str) -> None:
    (capture / file).unlink(missing_ok=True) if body is None else (capture / file).write_text(body)
    code, said = call()
    assert code == 4 and told in said


# -- outputs, disks and interrupts ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("output", "code", "told"),
    [
        ("nowhere/scene.ply", 4, "nowhere does not exist; create it first"),
        ("scene.xyz", 2, "scenes are written as"),
        (".", 2, "scenes are written as"),
    ],
)
def test_an_output_that_cannot_be_is_refused_before_anything_is_read(
    capture: Path, call: Call, tmp_path: Path, output: str, code: int, told: str
) -> None:
    (capture / "transforms.json").unlink()  # it would be missed if it were looked for
    found, said = call(output=tmp_path / output, made=False)
    assert found == code and told in said


def test_a_folder_in_the_outputs_place_is_refused_even_by_force(call: Call, tmp_path: Path) -> None:
    (tmp_path / "scene.ply").mkdir()
    code, said = call("--force", output=tmp_path / "scene.ply", made=False)
    assert code == 2 and "is a folder" in said


@pytest.mark.slow
def test_a_disk_that_is_full_in_the_end_costs_no_training(
    call: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("scenewright.gaussians.fit.fitting.CHECKPOINT_EVERY", 0.0)
    real, output = os.fsync, tmp_path / "out/scene.ply"

    def full(handle: int) -> None:
        if "checkpoint" not in os.readlink(f"/proc/self/fd/{handle}"):
            raise OSError(28, "No space left on device")
        real(handle)

    output.parent.mkdir()
    with monkeypatch.context() as disk:
        disk.setattr(os, "fsync", full)
        code, said = call("--steps", 320, output=output, made=False)
    assert code == 4 and "No space left on device; the file there was not changed" in said
    assert f"the same command goes on from {output}.checkpoint" in said
    assert [p.name for p in output.parent.iterdir()] == ["scene.ply.checkpoint"]
    code, said = call("--steps", 320, output=output, made=False)
    assert code == 0 and "going on from" in said and [p.name for p in output.parent.iterdir()] == ["scene.ply"]


def test_a_disk_that_is_full_on_the_way_leaves_the_last_checkpoint(tmp_path: Path) -> None:
    path = tmp_path / "scene.ply.checkpoint"
    checkpoint.save(path, {"a": np.arange(3)}, {"steps": 1})
    with pytest.MonkeyPatch.context() as disk:
        disk.setattr(os, "fsync", lambda handle: (_ for _ in ()).throw(OSError(28, "No space left on device")))
        with pytest.raises(
            FileError, match=r"No space left on device; .*; free some disk space and run the same command again"
        ):
            checkpoint.save(path, {"a": np.arange(3)}, {"steps": 2})
    found = checkpoint.load(path)
    assert found is not None and found[1] == {"steps": 1} and [p.name for p in tmp_path.iterdir()] == [path.name]


def test_a_checkpoint_with_one_bit_changed_or_its_end_cut_off_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "c"
    checkpoint.save(path, {"a": np.arange(40), "b": np.zeros((0, 3), np.float32)}, {"steps": 7})
    whole = path.read_bytes()
    for place in range(0, len(whole), 5):
        path.write_bytes(whole[:place] + bytes([whole[place] ^ 1]) + whole[place + 1 :])
        with pytest.raises(FileError, match=r"cannot resume from .*; delete it to start over"):
            checkpoint.load(path)
        path.write_bytes(whole[:place])
        with pytest.raises(FileError, match="delete it to start over"):
            checkpoint.load(path)


def test_dropping_a_checkpoint_takes_along_what_a_crash_left_of_it(tmp_path: Path) -> None:
    path = tmp_path / "s[1].ply.checkpoint"
    checkpoint.save(path, {"a": np.arange(3)}, {})
    left, other = tmp_path / f".{path.name}.0123456789ab.part", tmp_path / ".other.0123456789ab.part"
    left.write_bytes(b"half")
    other.write_bytes(b"of somebody else")
    checkpoint.delete(path)
    checkpoint.delete(path)
    assert [p.name for p in tmp_path.iterdir()] == [other.name]


# The command line, with a checkpoint at every chance instead of every half minute.
EAGER = """
import sys
from scenewright.gaussians.fit import fitting
fitting.CHECKPOINT_EVERY = 0.0
from scenewright.agent.cli import main
main(sys.argv[1:])
"""


def eager(capture: Path, output: Path) -> list[str]:
    options = ["--steps", "420", "--max-gaussians", "450", "--sh-degree", "1"]
    return [sys.executable, "-c", EAGER, "fit", str(capture), "-o", str(output), *options]


@pytest.mark.slow
def test_a_training_that_was_ended_goes_on_to_the_same_bytes(capture: Path, tmp_path: Path) -> None:
    whole = tmp_path / "whole.ply"
    subprocess.run(eager(capture, whole), check=True, capture_output=True)
    for how, code in ((signal.SIGKILL, -9), (signal.SIGINT, 130)):
        broken = tmp_path / f"{how.name}.ply"
        kept = Path(f"{broken}.checkpoint")
        with subprocess.Popen(eager(capture, broken), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as run:
            while not kept.exists() and run.poll() is None:
                time.sleep(0.001)
            run.send_signal(how)
            _, said = run.communicate()
        assert run.returncode == code and not broken.exists() and kept.exists()
        assert how == signal.SIGKILL or f"the same command goes on from {kept}" in said
        again = subprocess.run(eager(capture, broken), check=True, capture_output=True, text=True)
        assert f"going on from {kept}" in again.stderr
        assert broken.read_bytes() == whole.read_bytes() and not list(tmp_path.glob(".*")) and not kept.exists()
