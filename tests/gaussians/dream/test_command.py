"""Programs that write Gaussians: what they are given, what they may do wrong, and which way is up."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path

import numpy as np
import pytest
import torch

from scenewright.gaussians.assets import make
from scenewright.gaussians.dream.command import arguments, run
from scenewright.gaussians.dream.generating import Generator, from_command
from scenewright.gaussians.dream.prior import kind_of, standing
from scenewright.gaussians.dream.upright import TURNS, upright
from scenewright.gaussians.errors import BackendError, UserError
from scenewright.gaussians.files import save
from scenewright.gaussians.rotations import from_matrix, multiply
from scenewright.gaussians.scene import Scene


def _turned(axis: str, kind: str = "armchair") -> Scene:
    """A library thing whose `axis` points up."""
    cloud, back = make(kind, 0).cloud, TURNS[axis].T
    spin = from_matrix(torch.from_numpy(back.copy())).to(torch.float32)
    means = torch.from_numpy((cloud.means.double().numpy() @ back.T).astype(np.float32))
    return Scene(cloud.replace(means=means, quats=multiply(spin, cloud.quats)))


def _program(tmp_path: Path, body: str) -> str:
    path = tmp_path / "program.py"
    path.write_text(f"import shutil, sys\n{body}\n")
    return f"command:{shlex.quote(sys.executable)} {shlex.quote(str(path))}"


def _of_opacity(count: int, opacity: float) -> str:
    """A program that writes so many Gaussians of an opacity."""
    return (
        "import torch; from scenewright.gaussians.cloud import GaussianCloud; "
        "from scenewright.gaussians.files import save; from scenewright.gaussians.scene import Scene; "
        f"n = {count}; save(Scene(GaussianCloud.create(torch.rand(n, 3), torch.tensor([[1.0, 0, 0, 0]]).repeat(n, 1), "
        f"torch.full((n, 3), 0.1), torch.full((n,), {opacity}), torch.zeros(n, 1, 3))), sys.argv[1])"
    )


def test_words_and_paths_are_filled_in_once() -> None:
    spec = "command:prog --text={prompt} '{image}' -o {output} 'a b'"
    found = arguments(spec, "a {output}; rm -rf /", Path("in put.png"), Path("out.ply"))
    assert found == ["prog", "--text=a {output}; rm -rf /", "in put.png", "-o", "out.ply", "a b"]


@pytest.mark.parametrize(
    ("spec", "image", "said"),
    [
        ("command:", None, "names no program"),
        ("command:prog {prompt}", None, "output"),
        ("command:prog 'x {output}", None, "close its quotes"),
        ("command:prog {image} {output}", None, "wants a picture"),
        ("command:prog {prompt} {output}", Path("a.png"), "takes no picture"),
    ],
)
def test_specifications_that_make_no_sense(spec: str, image: Path | None, said: str) -> None:
    with pytest.raises(UserError, match=said):
        arguments(spec, "a chair", image, Path("out.ply"))


@pytest.mark.parametrize(
    ("body", "said"),
    [
        ("sys.exit(3)", "ended with 3: it says nothing"),
        ("print('no memory', file=sys.stderr); sys.exit(1)", "no memory"),
        ("pass", "wrote nothing"),
        ("open(sys.argv[1], 'w').write('nonsense')", "cannot be used"),
        ("import time; time.sleep(30)", "longer than"),
        (_of_opacity(7, 0.9), "wrote 7 Gaussians, of which 7 can be seen"),
        (_of_opacity(60, 0.001), "wrote 60 Gaussians, of which 0 can be seen"),
    ],
)
def test_programs_that_fail_are_named(tmp_path: Path, body: str, said: str) -> None:
    with pytest.raises(BackendError, match=said):
        run(f"{_program(tmp_path, body)} {{output}}", "a chair", None, 0.4 if "sleep" in body else 20)
    with pytest.raises(BackendError, match="there is no program"):
        run("command:/nowhere/program {output}", "a chair", None, 5)


@pytest.mark.parametrize("axis", ["-x", "-y", "-z"])
def test_up_may_be_the_other_way(axis: str) -> None:
    """The turn that brings the axis up is a rotation, and undone by that of the axis it is opposite to."""
    turn = TURNS[axis]
    assert np.allclose(turn @ turn.T, np.eye(3)) and np.linalg.det(turn) == pytest.approx(1.0)
    assert (turn[2] == -TURNS[axis[1]][2]).all()
    lamp = make("floor lamp", 0).cloud
    other = lamp.replace(means=lamp.means @ torch.from_numpy(turn).float())  # as a file with that axis up has it
    assert torch.allclose(upright(other, None, axis)[0].means, lamp.means, atol=1e-5)  # type: ignore[arg-type]


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e5])
def test_what_is_made_has_the_longest_side_of_its_kind_however_large_it_comes(scale: float) -> None:
    lamp = make("floor lamp", 0).cloud
    made = standing(lamp.replace(means=lamp.means * scale, scales=lamp.scales * scale), "a floor lamp").cloud.means
    wanted = max(kind_of("a floor lamp").usual_size)  # type: ignore[union-attr]
    assert float((made.max(dim=0).values - made.min(dim=0).values).max()) == pytest.approx(wanted, rel=0.03)


@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_up_is_told_or_found(axis: str) -> None:
    """By proportions, for a thing that is much taller than wide; of an armchair it needs to be told."""
    lamp = _turned(axis, "floor lamp")
    straight, found = upright(lamp.cloud, kind_of("a floor lamp"))
    assert found == axis
    assert torch.allclose(straight.means, make("floor lamp", 0).cloud.means, atol=1e-5)
    chair = upright(_turned(axis).cloud, kind_of("an armchair"), axis)[0]  # type: ignore[arg-type]
    assert torch.allclose(chair.means, make("armchair", 0).cloud.means, atol=1e-5)
    assert upright(lamp.cloud, None)[1] == "y"


def test_what_a_program_makes_stands_in_metres_and_is_kept(tmp_path: Path) -> None:
    save(_turned("y", "floor lamp"), tmp_path / "made.ply")
    count = tmp_path / "count"
    made = tmp_path / "made.ply"
    body = f"open({str(count)!r}, 'a').write('x')\nshutil.copy({str(made)!r}, sys.argv[2])"
    spec = f"{_program(tmp_path, body)} {{prompt}} {{output}}"
    scene, axis, repaired = from_command(spec, "a floor lamp", None, 20)
    assert axis == "y" and not repaired and scene.frame.metres_per_unit == 1.0
    tall = float(scene.cloud.means[:, 2].max() - scene.cloud.means[:, 2].min())
    assert 1.2 < tall < 2.2
    keeps = Generator(spec, 20, folder=tmp_path / "kept")
    assert keeps.path("a floor lamp") == keeps.path("a floor lamp")
    assert keeps.path("a lamp") != keeps.path("a floor lamp")
    assert count.read_text() == "xxx"  # once by hand, then once for each prompt
    with pytest.raises(BackendError, match="unknown model"):
        Generator("onnx:x")


def test_rows_that_are_no_numbers_are_left_out_and_told(tmp_path: Path) -> None:
    lamp = _turned("y", "floor lamp").cloud
    broken = lamp.means.clone()
    broken[:3, 0] = float("nan")
    made = tmp_path / "made.ply"
    save(Scene(lamp.replace(means=broken)), made)
    spec = f"{_program(tmp_path, f'shutil.copy({str(made)!r}, sys.argv[1])')} {{output}}"
    scene, _, repaired = from_command(spec, "a floor lamp", None, 20)
    assert len(scene.cloud) == len(lamp) - 3
    assert repaired == (f"3 of {len(lamp):,} Gaussians were dropped: NaN or infinite values",)
