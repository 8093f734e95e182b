"""scenewright dream: what it says and writes without a model."""

from __future__ import annotations

import shlex
from pathlib import Path

import pytest

from scenewright.agent.cli import main
from scenewright.gaussians.assets import make
from scenewright.gaussians.files import load, save
from scenewright.gaussians.scene import Scene


def _run(*arguments: object) -> int:
    with pytest.raises(SystemExit) as end:
        main(["dream", *map(str, arguments)])
    return int(end.value.code or 0)


def test_without_a_model_it_says_what_to_do(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert _run("a red armchair", "-o", tmp_path / "chair.ply") == 2
    said = capsys.readouterr().err
    assert "scenewright[diffusion]" in said and "--model library" in said and "armchair" in said
    assert _run("an astronaut", "-o", tmp_path / "astronaut.ply") == 2
    assert "library" not in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_the_library_stands_in(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "chair.ply"
    assert _run("a red armchair", "-o", out, "--model", "library") == 0
    assert "nothing was dreamt" in capsys.readouterr().out
    assert load(out).frame.metres_per_unit == 1.0
    assert _run("a red armchair", "-o", out, "--model", "library") == 2  # never overwritten unasked


@pytest.mark.parametrize(
    "wrong",
    [
        ("--steps", 3, "--minutes", 1),
        ("--height", 0),
        ("--height", "nan"),
        ("--guidance", "nan"),
        ("--from", "sphere"),
        ("--image", "none.png"),
    ],
)
def test_options_that_make_no_sense(tmp_path: Path, wrong: tuple[object, ...]) -> None:
    assert _run("a chair", "-o", tmp_path / "chair.ply", "--model", "library", *wrong) == 2
    assert not list(tmp_path.iterdir())


def test_what_is_left_out_of_what_a_program_wrote_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    lamp = make("floor lamp", 0).cloud
    means = lamp.means.clone()
    means[0] = float("nan")
    save(Scene(lamp.replace(means=means)), tmp_path / "made.ply")
    model = f"command:cp {shlex.quote(str(tmp_path / 'made.ply'))} {{output}}"
    assert _run("a floor lamp", "-o", tmp_path / "lamp.ply", "--model", model) == 0
    assert f"in what the program wrote, 1 of {len(lamp):,} Gaussians were dropped" in capsys.readouterr().err
