"""scenewright dream: what it says and writes without a model."""

from __future__ import annotations

from pathlib import Path

import pytest

from scenewright.agent.cli import main
from scenewright.gaussians.files import load


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
