"""The command line on scenes with time: stills and films at a time, sequences of files out and in, what is told."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from PIL import Image

from scenewright.agent import sequences
from scenewright.gaussians import files
from scenewright.gaussians.files.motion_file import motion_path
from scenewright.gaussians.language.field.loading import load
from scenewright.gaussians.language.field.saving import save
from scenewright.gaussians.motion.at import at
from scenewright.gaussians.motion.motion import Look, Motion, Track
from scenewright.gaussians.scene import Scene


@pytest.fixture
def slid(boxes: Scene) -> Scene:
    """The boxes, of which the first thing rises by two units in two seconds."""
    ids = boxes.cloud.ids[boxes.cloud.group == 0].numpy()
    return boxes.replace(language=None, motion=Motion((Track.slide(ids, [0, 2], [0, 2.0], (0, 0, 1)),), stop=2.0))


@pytest.fixture
def room(slid: Scene, tmp_path: Path) -> Path:
    files.save(slid, tmp_path / "room.ply")
    return tmp_path / "room.ply"


def pixels(path: Path) -> Any:
    return np.asarray(Image.open(path).convert("RGB")).astype(int)


def test_a_picture_at_a_time_is_that_of_the_scene_at_that_time(call: Any, slid: Scene, room: Path) -> None:
    folder = room.parent
    files.save(at(slid, 1.0), folder / "at1.ply")
    for name, scene, more in (("a", "room", ("--time", "1")), ("b", "at1", ()), ("c", "room", ())):
        answer = call("render", folder / f"{scene}.ply", "-o", folder / f"{name}.png", "--size", "48x32",
                      "--view", "0,-6,2:0,0,0.5", *more, "--json")  # fmt: skip
        assert answer.code == 0, answer.err
        assert answer.data.get("time") == (1.0 if more else None)
    assert np.array_equal(pixels(folder / "a.png"), pixels(folder / "b.png"))
    assert not np.array_equal(pixels(folder / "a.png"), pixels(folder / "c.png"))


def test_a_film_through_time_from_a_view_and_on_an_orbit(call: Any, room: Path, tmp_path: Path) -> None:
    answer = call("render", room, "--time", "0:1", "--fps", 4, "-o", tmp_path / "film", "--size", "48x32", "--json")
    assert (answer.code, answer.data["pictures"], answer.data["time"]) == (0, 5, [0.0, 1.0])
    drawn = [pixels(path) for path in sorted((tmp_path / "film").iterdir())]
    assert all(not np.array_equal(a, b) for a, b in itertools.pairwise(drawn))
    slow = call("render", room, "--time", ":", "--seconds", 2, "--fps", 2, "-o", tmp_path / "a.gif", "--size", "48x32",
                "--json")  # fmt: skip
    assert (slow.data["pictures"], slow.data["time"]) == (5, [0.0, 2.0])
    around = call("render", room, "--time", "0:2", "--orbit", 3, "-o", tmp_path / "b.gif", "--size", "48x32", "--json")
    assert (around.data["pictures"], around.data["time"]) == (3, [0.0, 2.0])


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--time", "soon"), "seconds as in 2.5 or 0:5"),
        (("--time", "2:1", "--fps", "2"), "ends before it begins"),
        (("--time", "0:1"), "is for many pictures"),
        (("--time", "nan"), "seconds as in 2.5 or 0:5"),
        (("--time", "nan", "--fps", "2"), "seconds as in 2.5 or 0:5, not 'nan'"),
        (("--time", "a:b"), "seconds as in 2.5 or 0:5, not 'a:b'"),
        (("--time", "1", "--fps", "2"), "for many pictures, and --time 1 is one"),
        (("--time", ""), "seconds as in 2.5 or 0:5"),
    ],
)
def test_what_is_no_time_is_refused(call: Any, room: Path, arguments: tuple[str, ...], said: str) -> None:
    answer = call("render", room, *arguments, "-o", room.parent / ("film" if "--fps" in arguments else "a.png"))
    assert answer.code == 2 and said in answer.err


def test_a_static_scene_has_no_times(call: Any, boxes: Scene, tmp_path: Path) -> None:
    files.save(boxes.replace(language=None), tmp_path / "still.ply")
    answer = call("render", tmp_path / "still.ply", "--time", "1", "-o", tmp_path / "a.png")
    assert answer.code == 2 and "nothing moves in still.ply; leave out --time" in answer.err
    assert call("info", tmp_path / "still.ply", "--json").data["motion"] is None


@pytest.mark.slow
def test_a_sequence_is_written_and_read_as_the_motion_that_it_was(call: Any, slid: Scene, room: Path) -> None:
    folder = room.parent
    out = call("convert", room, folder / "frames" / "%03d.ply", "--time", "0:2", "--fps", 4, "--json")
    assert (out.code, out.data["files"]) == (0, 9), out.err
    names = sorted(path.name for path in (folder / "frames").iterdir())
    assert names == [f"{i:03d}.ply" for i in range(9)]  # static files, nothing beside them
    back = call("convert", folder / "frames" / "*.ply", folder / "back.ply", "--fps", 4, "--views", 1, "--json")
    assert back.code == 0, back.err
    assert any("1 body moves" in note for note in back.data["notes"])
    again = files.load(folder / "back.ply")
    assert again.motion is not None and again.motion.stop == 2.0
    for time in (0.25, 1.0, 2.0):  # of a frame, where it is exact but for what keys leave out
        torch.testing.assert_close(at(again, time).cloud.means, at(slid, time).cloud.means, atol=2e-3, rtol=0)
    numbered = call("convert", folder / "frames" / "%03d.ply", folder / "again.ply", "--fps", 4, "--views", 0, "--json")
    assert numbered.code == 0
    assert motion_path(folder / "again.ply").stat().st_size == motion_path(folder / "back.ply").stat().st_size


def test_names_go_along_to_a_time_into_a_sequence_and_back(call: Any, slid: Scene, boxes: Scene, room: Path) -> None:
    folder = room.parent
    save(slid.replace(language=boxes.language), folder / "named.ply")
    assert call("convert", folder / "named.ply", folder / "at.ply", "--time", "2", "--views", 0).code == 0
    raised = load(folder / "at.ply").language
    assert raised is not None and boxes.language is not None
    assert raised.groups[0].box.center[2] == pytest.approx(boxes.language.groups[0].box.center[2] + 2, abs=1e-4)
    assert raised.groups[1:] == boxes.language.groups[1:]
    assert call("convert", folder / "named.ply", folder / "frames" / "%d.ply", "--time", "0:2", "--fps", 2).code == 0
    assert load(folder / "frames" / "4.ply").language is not None
    assert call("convert", folder / "frames" / "*.ply", folder / "back.ply", "--fps", 2, "--views", 0).code == 0
    back = load(folder / "back.ply")
    assert back.motion is not None and back.language is not None
    assert [g.label for g in back.language.groups] == [g.label for g in boxes.language.groups]


def test_a_file_that_is_missing_leaves_its_time_in_a_sequence(call: Any, slid: Scene, room: Path) -> None:
    folder = room.parent
    assert call("convert", room, folder / "frames" / "%03d.ply", "--time", "0:2", "--fps", 4).code == 0
    (folder / "frames" / "003.ply").unlink()
    back = call("convert", folder / "frames" / "*.ply", folder / "back.ply", "--fps", 4, "--views", 0, "--json")
    assert any("missing between 002.ply and 004.ply" in note for note in back.data["notes"])
    again = files.load(folder / "back.ply")
    assert again.motion is not None and again.motion.stop == 2.0
    torch.testing.assert_close(at(again, 1.0).cloud.means, at(slid, 1.0).cloud.means, atol=2e-3, rtol=0)


def test_files_are_numbered_by_the_number_in_which_they_differ() -> None:
    def of(*names: str) -> tuple[list[float], int]:
        times, notes = sequences.times_of([Path(name) for name in names], 2.0)
        return times, len(notes)

    assert of("room2_0010.ply", "room2_0020.ply", "room2_0040.ply") == ([0.0, 0.5, 1.5], 1)
    assert of("a.ply", "b.ply", "c.ply") == ([0.0, 0.5, 1.0], 0)
    assert of("1.ply", "2_5.ply", "3.ply") == ([0.0, 0.5, 1.0], 0)


def test_what_is_hidden_for_a_while_stays_in_a_sequence(call: Any, slid: Scene, room: Path) -> None:
    folder, motion = room.parent, slid.motion
    assert motion is not None
    ids = slid.cloud.ids[:40].numpy()
    hidden = Look(ids, 0.5, 1.2, opacities=torch.zeros(40))
    files.save(slid.replace(motion=motion.replace(looks=(hidden,))), room, force=True)
    assert call("convert", room, folder / "frames" / "%03d.ply", "--time", "0:2", "--fps", 4).code == 0
    each = [files.load(path).cloud for path in sorted((folder / "frames").iterdir())]
    assert {len(cloud) for cloud in each} == {len(slid.cloud)}
    assert float(each[3].opacities[:40].max()) < 0.01 < float(each[0].opacities[:40].min())
    back = call("convert", folder / "frames" / "*.ply", folder / "back.ply", "--fps", 4, "--views", 0, "--json")
    assert back.code == 0 and any("change their colour or opacity" in note for note in back.data["notes"])


def test_a_time_beyond_the_film_is_told(call: Any, room: Path) -> None:
    answer = call("render", room, "--time", "9", "-o", room.parent / "late.png", "--size", "32x24")
    assert answer.code == 0 and "lasts from 0 to 2 s" in answer.err
    answer = call("render", room, "--time", "0:9", "--fps", "1", "-o", room.parent / "film", "--size", "32x24")
    assert answer.code == 0 and "lasts from 0 to 2 s; before and after, it stays as it is\n" in answer.err
    spun = files.load(room)
    spin = Track.spin(spun.cloud.ids.numpy()[:5], 1.0, (0, 0, 1), (0, 0, 0))
    files.save(spun.replace(motion=Motion((spin,), stop=2.0)), room, force=True)
    answer = call("render", room, "--time", "9", "-o", room.parent / "spun.png", "--size", "32x24")
    assert "but what spins goes on" in answer.err


def test_one_time_is_one_file_and_other_formats_keep_the_motion(call: Any, slid: Scene, room: Path) -> None:
    folder = room.parent
    assert call("convert", room, folder / "one.ply", "--time", "2", "--views", 0).code == 0
    one = files.load(folder / "one.ply")
    assert one.motion is None and torch.equal(one.cloud.means, at(slid, 2.0).cloud.means)
    assert call("convert", room, folder / "room.2.spz", "--spz-version", 3, "--views", 0).code == 0
    packed = files.load(folder / "room.2.spz")
    there, here = at(packed, 2.0).cloud.means, at(slid, 2.0).cloud.means
    assert float(torch.cdist(here, there).min(dim=1).values.max()) < 0.01


@pytest.mark.parametrize(
    ("arguments", "code", "said"),
    [
        (("room.ply", "%d.ply"), 2, "how many files make a second: --fps 10"),
        (("room.ply", "a.ply", "--time", "0:1"), 2, "write OUT as a pattern"),
        (("room.ply", "a.ply", "--fps", "4"), 2, "--fps is for sequences"),
        *[(("r*.ply", "a.ply", "--fps", fps), 2, "above 0 and below 10,000, not") for fps in ("0", "nan", "-5")],
        (("room.ply", "%d.ply", "--fps", "0"), 2, "above 0 and below 10,000, not 0"),
        (("none*.ply", "a.ply", "--fps", "4"), 4, "a sequence needs two or more"),
        (("r*m.ply", "a.ply", "--fps", "4"), 4, "names 1 files"),
        (("room.ply", "*.ply", "--fps", "4"), 2, "write for example %04d.ply"),
    ],
)
def test_what_is_no_sequence_is_refused(
    call: Any, room: Path, monkeypatch: pytest.MonkeyPatch, arguments: tuple[str, ...], code: int, said: str
) -> None:
    monkeypatch.chdir(room.parent)
    answer = call("convert", *arguments)
    assert answer.code == code and said in answer.err


def test_info_tells_what_moves(call: Any, room: Path) -> None:
    answer = call("info", room)
    assert "motion from 0 to 2 s: 343 Gaussians move (1 slide)" in answer.out
    data = call("info", room, "--json").data["motion"]
    assert data["moving"] == 343 and data["tracks"][0]["kind"] == "slide" and data["tracks"][0]["time"] == [0.0, 2.0]


def test_slim_keeps_the_motion(call: Any, room: Path) -> None:
    folder = room.parent
    assert call("slim", room, "-o", folder / "small.ply", "--psnr", "inf").code == 0
    assert files.load(folder / "small.ply").motion is not None
