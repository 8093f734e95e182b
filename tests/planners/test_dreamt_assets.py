"""--assets dream:...: what the library does not draw is made, and what it draws is not."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path

import pytest

from scenewright.gaussians.assets import make
from scenewright.gaussians.errors import BackendError
from scenewright.gaussians.files import save
from scenewright.gaussians.scene import Scene
from scenewright.planners.rooms.build import construct
from scenewright.planners.rooms.graph import SceneGraph
from scenewright.planners.rooms.own_assets import OwnAssets, own_assets


@pytest.fixture
def dreams(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> OwnAssets:
    """A program that writes a red armchair whatever it is asked for, and notes the prompt."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    save(Scene(make("armchair", 0, color="red").cloud), tmp_path / "made.ply")
    program = tmp_path / "program.py"
    program.write_text(
        f"import shutil, sys\nopen({str(tmp_path / 'asked')!r}, 'a').write(sys.argv[1] + '\\n')\n"
        f"shutil.copy({str(tmp_path / 'made.ply')!r}, sys.argv[2])\n"
    )
    found = own_assets(f"dream:command:{shlex.quote(sys.executable)} {shlex.quote(str(program))} {{prompt}} {{output}}")
    assert found is not None
    return found


def test_only_what_the_library_does_not_draw_is_made(dreams: OwnAssets, tmp_path: Path) -> None:
    assert dreams.natural("armchair", "blue") == (None, ())
    made, told = dreams.natural("astronaut", "blue")
    assert made is not None and max(made.size) == pytest.approx(1.0, abs=0.1)
    assert "made by command:" in told[0]
    assert dreams.natural("astronaut", "blue")[0] is not None  # kept
    assert (tmp_path / "asked").read_text() == "a blue astronaut\n"


def test_a_room_takes_them(dreams: OwnAssets, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    graph = SceneGraph.model_validate(
        {
            "room": {"size": [4, 4, 2.5]},
            "nodes": [
                {"id": 1, "label": "zorb", "size": [1, 1, 1], "position": [0, 0, 0.5], "support": "floor"},
                {
                    "id": 2,
                    "label": "armchair",
                    "size": [0.8, 0.8, 0.9],
                    "position": [1.2, 1.2, 0.45],
                    "support": "floor",
                },
            ],
        }
    )
    generator = dreams.generator  # type: ignore[attr-defined]
    built = construct(graph, assets=f"dream:{generator.spec}", detail=0.3)
    assert any("zorb: made by" in note for note in built.notes)
    assert (tmp_path / "asked").read_text() == "a zorb\n"


def test_unknown_generators_are_told_at_once() -> None:
    with pytest.raises(BackendError, match="unknown model"):
        own_assets("dream:onnx:x")


def test_a_thing_keeps_its_proportions_within_its_place(dreams: OwnAssets) -> None:
    natural = dreams.natural("astronaut", None)[0]
    taken = dreams.take("astronaut", (0.4, 0.4, 0.3), None, False).asset
    assert natural is not None and taken is not None
    factors = [a / b for a, b in zip(taken.size, natural.size, strict=True)]
    assert max(factors) == pytest.approx(min(factors), rel=0.05)
    assert taken.size[0] <= 0.41 and taken.size[1] <= 0.41 and taken.size[2] <= 0.61


def test_what_cannot_be_made_is_told_and_left_to_others() -> None:
    found = own_assets(f"dream:command:{shlex.quote(sys.executable)} -c 'raise SystemExit(3)' {{output}}")
    assert found is not None
    taken = found.take("zorb", (1.0, 1.0, 1.0), None, False)
    assert taken.asset is None and "zorb: " in taken.notes[0] and "ended with 3" in taken.notes[0]
