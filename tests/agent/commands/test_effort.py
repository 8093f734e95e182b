"""`--effort` of commands: what is chosen, what the receipt says, and what wins over it."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from scenewright.agent import calibrating
from scenewright.gaussians import files
from scenewright.gaussians.effort import points, user_file
from scenewright.gaussians.language.field.store import save_field
from scenewright.gaussians.scene import Scene


@pytest.fixture(autouse=True)
def place(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    path = tmp_path / "effort.json"
    monkeypatch.setenv("SCENEWRIGHT_EFFORT", str(path))
    return path


@pytest.fixture
def room(boxes: Scene, tmp_path: Path) -> Path:
    """The boxes with their language field."""
    files.save(boxes, tmp_path / "room.ply")
    save_field(boxes, tmp_path / "room.ply")
    return tmp_path / "room.ply"


@pytest.mark.parametrize("effort", ["quick", "nan", "0", "-2", "inf"])
@pytest.mark.parametrize("verb", ["embed", "select", "ask", "edit", "compose", "fit", "slim"])
def test_every_verb_refuses_what_is_no_effort(call: Any, tmp_path: Path, verb: str, effort: str) -> None:
    more = {"select": ["x"], "ask": ["x"], "edit": ["x", "-o", tmp_path / "b.ply"], "fit": ["-o", tmp_path / "b.ply"]}
    more |= {"slim": ["-o", tmp_path / "b.sog"]}
    code, _, err = call(verb, tmp_path / "a.ply", *more.get(verb, []), f"--effort={effort}")
    assert code == 2 and "fast, balanced, accurate or a number of seconds" in err


@pytest.mark.slow
def test_compose_searches_as_long_as_was_said(call: Any, tmp_path: Path) -> None:
    for effort, setting in (("fast", "search effort 0.2"), ("accurate", "search effort 2"), ("60", "search effort 2")):
        code, out, err = call("compose", "a room with a chair", "--effort", effort, "--json")
        assert code == 0 and json.loads(out)["nodes"]
        assert f"compose: {setting}" in err and "measured on" in err


def test_a_saved_field_leaves_nothing_to_choose(call: Any, room: Path) -> None:
    code, out, err = call("select", room, "everything", "--effort", "fast", "--json")
    assert code == 0, err
    told = json.loads(out)["effort"]
    assert told["effort"] == "fast" and told["points"] == [] and told["seconds"] > 0


@pytest.mark.slow
def test_filling_is_chosen_by_an_edit_that_reveals_something(call: Any, room: Path, tmp_path: Path) -> None:
    told: dict[str, Any] = {}
    for k, more in enumerate(
        (["--effort", "fast"], ["--effort", "accurate"], ["--effort", "fast", "--infill", "scene"])
    ):
        out_file = tmp_path / f"{k}.ply"
        code, out, err = call("edit", room, "delete all objects", "-o", out_file, "--yes", "--json", *more)
        assert code == 0, err + out
        told[str(k)] = json.loads(out)["effort"]
    assert told["0"]["points"][0]["settings"] == {"infill": False}
    assert told["1"]["points"][0]["settings"] == {"infill": True}
    assert told["2"]["points"] == [] and told["2"]["overruled"] == ["--infill"]


SLIM = ("--psnr", 30, "--pixels", 64, "--json", "--effort", "fast")


@pytest.mark.slow
def test_slim_has_one_point(call: Any, room: Path, tmp_path: Path) -> None:
    code, out, err = call("slim", room, "-o", tmp_path / "a.sog", *SLIM)
    assert code == 0, err
    assert json.loads(out)["steps"] == 0 and json.loads(out)["effort"]["points"][0]["method"] == "slim"


@pytest.mark.slow
def test_an_optimisation_wins_over_the_dial(call: Any, room: Path, tmp_path: Path) -> None:
    code, out, err = call("slim", room, "-o", tmp_path / "a.sog", *SLIM, "--optimise", "1steps")
    assert code == 0, err
    assert json.loads(out)["effort"]["overruled"] == ["an optimisation"] and json.loads(out)["steps"] > 0


def _instantly() -> Callable[[], object]:
    return lambda: sum(range(1000))


def test_calibration_writes_a_factor_for_every_method(call: Any, place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert set(calibrating.PROBES) == set(points.probes())
    monkeypatch.setattr(calibrating, "PROBES", dict.fromkeys(points.probes(), _instantly))
    code, out, err = call("bench", "calibrate", "--json")
    assert code == 0, err
    found, trouble = user_file.read()
    assert found is not None and not trouble and json.loads(out)["path"] == str(place)
    assert set(found.factors) == set(points.methods()) and all(f == calibrating.LOW for f in found.factors.values())


def test_calibration_stops_in_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(calibrating, "PROBES", dict.fromkeys(points.probes(), _instantly))
    monkeypatch.setattr(calibrating, "LONGEST", -1.0)
    found, seconds = calibrating.calibrated()
    assert found.factors == {} and seconds == {}
