"""Textures from pictures: their period, their shading, their seams; and things that get the surface of another."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from numpy.typing import NDArray
from PIL import Image

from scenewright.benchmarks.restyle import wall
from scenewright.gaussians.camera import Camera
from scenewright.gaussians.errors import FileError, InstructionError, UserError
from scenewright.gaussians.scene import Scene
from scenewright.tools.execute import Done, carry_out
from scenewright.tools.finishing.exemplar import Exemplar, Picture, exemplar_of, flattened, pigment_of
from scenewright.tools.finishing.periods import periods
from scenewright.tools.finishing.photograph import Photograph, named, read_photograph
from scenewright.tools.finishing.sampled import largest_rectangle, texture_of
from scenewright.tools.finishing.textures import Spots
from scenewright.tools.operation import Context
from scenewright.tools.placement.bodies import bodies_of
from scenewright.tools.registry import parse

F64 = NDArray[np.float64]


def stripes(size: int, period: float, axis: int = 1) -> F64:
    """A red and white picture whose stripes follow each other along an axis."""
    places = np.arange(size) + 0.5
    wave = 0.5 + 0.5 * np.tanh(4 * np.sin(2 * np.pi * places / period))
    share = (wave[None, :] if axis == 1 else wave[:, None]) * np.ones((size, size))
    return np.asarray(np.array([0.8, 0.2, 0.2]) + share[..., None] * np.array([0.15, 0.7, 0.7]))


@pytest.mark.parametrize("period", [7.3, 12.0, 31.7])
def test_a_period_is_found_to_a_hundredth(period: float) -> None:
    found = periods(stripes(128, period) - 0.5)
    assert found.across == pytest.approx(period, rel=0.01)
    assert found.up is None
    turned = periods(stripes(128, period, axis=0) - 0.5)
    assert (turned.across, turned.up) == (None, pytest.approx(period, rel=0.01))


def test_noise_has_no_period() -> None:
    noise = np.random.default_rng(3).normal(size=(96, 96, 3))
    assert periods(noise)[:2] == (None, None)


def test_shading_is_divided_out_and_the_pattern_stays() -> None:
    picture = stripes(120, 20.0)
    shade = np.linspace(0.5, 1.0, 120)[None, :, None] * np.linspace(1.0, 0.7, 120)[:, None, None]
    flat, found = flattened(picture * shade)
    blocks = flat.reshape(3, 40, 3, 40, 3).mean(axis=(1, 3)) @ np.array([0.3, 0.6, 0.1])  # two periods each
    assert float(blocks.max() / blocks.min()) < 1.06  # 2.9 before
    assert found.across == pytest.approx(20.0, rel=0.01)
    hue = flat[..., 0] / flat[..., 1]
    assert float(np.median(hue[:, 4:8])) == pytest.approx(
        float(np.median((picture[..., 0] / picture[..., 1])[:, 4:8])), rel=0.03
    )


def laid(texture: Exemplar, size: int, cell: float) -> F64:
    """A picture of a wall with a texture on it."""
    places = (np.arange(size) + 0.5) * cell
    x, y = np.meshgrid(places, places)
    plane = np.stack([x.ravel(), y.ravel()], axis=1).astype(np.float32)
    n = size * size
    normal = np.tile(np.array([0, 1, 0], np.float32), (n, 1))
    spots = Spots(np.zeros((n, 3), np.float32), plane, normal, np.full(n, cell / 4, np.float32), 0)
    return pigment_of(texture, spots).reshape(size, size, 3).astype(np.float64)


def test_a_texture_repeats_with_the_period_of_its_picture_and_no_seam() -> None:
    texture = exemplar_of(Picture(stripes(100, 13.7), np.ones((100, 100), bool), 0.01, lies=False))
    assert texture.period == (pytest.approx(0.137, rel=0.01), None)
    shown = laid(texture, 300, 0.01)
    assert periods(shown - shown.mean(axis=(0, 1))).across == pytest.approx(13.7, rel=0.01)
    steps = np.abs(np.diff(shown[..., 1], axis=1)).max(axis=0)
    assert float(steps.max()) < 1.3 * float(steps[:40].max())  # no step that the picture itself does not have


def test_a_texture_without_a_period_meets_itself() -> None:
    rng = np.random.default_rng(1)
    from scipy import ndimage

    noise = ndimage.gaussian_filter(rng.normal(size=(80, 80)), 2.0)
    picture = 0.5 + 0.15 * (noise / noise.std())[..., None] * np.ones(3)
    texture = exemplar_of(Picture(np.clip(picture, 0, 1), np.ones((80, 80), bool), 0.01, lies=False))
    assert texture.period == (None, None)
    tile = texture.levels[0].mean(axis=2)
    inner = np.abs(np.diff(tile, axis=1))
    across = np.abs(tile[:, 0] - tile[:, -1])
    assert float(across.mean()) < 2.0 * float(inner.mean())
    assert float(tile.std()) > 0.7 * float(picture.std())  # nothing was smoothed away


def test_blur_takes_the_contrast_and_keeps_the_mean() -> None:
    texture = exemplar_of(Picture(stripes(100, 10.0), np.ones((100, 100), bool), 0.01, lies=False))
    contrast = [level.std() for level in texture.levels]
    assert contrast == sorted(contrast, reverse=True)
    means = texture.levels.mean(axis=(1, 2))
    assert float(np.abs(means - means[0]).max()) < 1e-3


def test_cells_that_are_not_known_are_filled() -> None:
    known = np.ones((100, 100), bool)
    known[40:60, 30:50] = False
    picture = np.where(known[..., None], stripes(100, 10.0), 0.0)
    texture = exemplar_of(Picture(picture, known, 0.01, lies=False))
    assert texture.period[0] == pytest.approx(0.1, rel=0.02)
    assert float(texture.levels[0][..., 0].min()) > 0.5


@pytest.mark.parametrize(("holes", "found"), [(0.0, (0, 0, 10, 8)), (0.2, (0, 0, 10, 10))])
def test_the_largest_rectangle(holes: float, found: tuple[int, int, int, int]) -> None:
    mask = np.ones((10, 10), bool)
    mask[:, 8] = mask[3, 9] = False
    assert largest_rectangle(mask, holes) == found
    assert largest_rectangle(np.zeros((4, 4), bool), 0.1) is None


# -- things -----------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def striped() -> tuple[Scene, Context]:
    context = Context(Camera.look_at([1.6, -6, 1.2], [1.6, 0, 1.2], [0, 0, 1], 512, 384))
    unit = {"value": 0.3}
    op = parse({"op": "restyle", "target": {"groups": [0]}, "material": "stripes", "color": "red", "unit": unit})
    return carry_out(wall(), op, context).scene, context


def test_the_texture_of_a_thing_has_its_period_and_its_hues(striped: tuple[Scene, Context]) -> None:
    scene, context = striped
    from scenewright.gaussians.language.query.query import Query

    (body,) = bodies_of(scene, context.resolve(scene, Query(groups=(0,))))
    texture = texture_of(scene, body, 1.0, "wall")
    assert texture.period[0] == pytest.approx(0.3, rel=0.02)
    red, green, _ = texture.mean
    assert red > green + 0.1


def like(corner: Scene, context: Context, target: str, source: str, **more: Any) -> Done:
    op = {"op": "restyle", "target": {"text": target}, "like": {"text": source}, **more}
    return carry_out(corner, parse(op), context)


@pytest.mark.slow
def test_a_thing_gets_the_pattern_of_another(corner: Scene, context: Context) -> None:
    op = {"op": "restyle", "target": {"text": "floor"}, "material": "checks", "color": "red", "unit": {"value": 0.3}}
    checked = carry_out(corner, parse(op), context).scene
    done = like(checked, context, "table", "floor")
    assert "repeats every 0.3" in " ".join(done.receipt.notes)
    assert done.receipt.passed
    kept = checked.cloud.group != 0
    after = done.scene.cloud.group != 0
    for name, column in checked.cloud.columns():
        assert torch.equal(column[kept], getattr(done.scene.cloud, name)[after]), name
    again = like(checked, context, "table", "floor")
    assert all(
        torch.equal(a, b)
        for (_, a), (_, b) in zip(done.scene.cloud.columns(), again.scene.cloud.columns(), strict=True)
    )


@pytest.mark.slow
def test_a_thing_is_not_its_own_model(corner: Scene, context: Context) -> None:
    with pytest.raises(InstructionError, match="part of what is to be changed"):
        like(corner, context, "table", "table")


@pytest.mark.slow
def test_what_is_too_coarse_gives_no_pattern(corner: Scene, context: Context) -> None:
    coarse = corner.replace(cloud=corner.cloud[(corner.cloud.group != 3) | (corner.cloud.ids % 40 == 0)])
    coarse = coarse.replace(cloud=coarse.cloud.replace(scales=coarse.cloud.scales * 3))
    with pytest.raises(InstructionError, match=r"too coarse|no flat part"):
        like(coarse, context, "table", "vase")
    done = like(coarse, context, "table", "vase", material="porcelain")  # the colour is known all the same
    assert "its colour was taken" in " ".join(done.receipt.notes)


@pytest.mark.parametrize(
    "wrong", [{"like": {"text": "table"}, "reference": "photo"}, {"width": {"value": 1}}, {"reference": ""}, {}]
)
def test_one_source_is_given(wrong: dict[str, Any]) -> None:
    with pytest.raises(UserError):
        parse({"op": "restyle", "target": {"text": "table"}, **wrong})


# -- photographs ------------------------------------------------------------------------------------------------------


def saved(path: Path, picture: F64, **more: Any) -> Path:
    Image.fromarray((picture * 255).astype(np.uint8)).save(path, **more)
    return path


@pytest.mark.slow
def test_a_photograph_is_reduced_upright_and_without_what_is_transparent(tmp_path: Path) -> None:
    wide = read_photograph(saved(tmp_path / "wide.png", np.kron(stripes(400, 40.0), np.ones((4, 8, 1)))))
    assert wide.rgb.shape == (256, 512, 3)
    exif = Image.Exif()
    exif[0x0112] = 6  # turned by 90 degrees
    turned = read_photograph(saved(tmp_path / "turned.jpg", stripes(100, 20.0)[:50], exif=exif))
    assert turned.rgb.shape == (100, 50, 3)
    half = np.concatenate([stripes(64, 8.0), np.ones((64, 64, 1))], axis=2)
    half[:32, :, 3] = 0
    clear = read_photograph(saved(tmp_path / "clear.png", half))
    assert clear.known[:32].all()
    assert not clear.known[32:].any()  # rows run upward


@pytest.mark.parametrize(
    ("name", "content", "told"),
    [
        ("missing.png", None, "No such file"),
        ("text.png", b"no picture", "no picture"),
        ("script.svg", b"<svg xmlns='http://www.w3.org/2000/svg'/>", "no picture"),
    ],
)
def test_bad_files_are_told(tmp_path: Path, name: str, content: bytes | None, told: str) -> None:
    if content is not None:
        (tmp_path / name).write_bytes(content)
    with pytest.raises(FileError, match=told):
        read_photograph(tmp_path / name)


def test_what_is_cut_short_small_or_clear_is_told(tmp_path: Path) -> None:
    whole = saved(tmp_path / "whole.png", stripes(64, 8.0)).read_bytes()
    (tmp_path / "cut.png").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(FileError):
        read_photograph(tmp_path / "cut.png")
    with pytest.raises(FileError, match="at least 24"):
        read_photograph(saved(tmp_path / "small.png", stripes(12, 4.0)))
    with pytest.raises(FileError, match="transparent"):
        read_photograph(saved(tmp_path / "clear.png", np.zeros((64, 64, 4))))
    with pytest.raises(UserError, match="left to right"):
        read_photograph(saved(tmp_path / "good.png", stripes(64, 8.0)), width=-1.0)


def photograph(name: str = "red.png", width: float | None = None) -> Photograph:
    return Photograph(name, stripes(100, 20.0).astype(np.float32), np.ones((100, 100), bool), width)


def test_a_plan_names_only_photographs_that_were_given(corner: Scene, context: Context) -> None:
    given = {"red.png": photograph()}
    assert named("photo", given).name == named("red", given).name == named("RED.PNG", given).name == "red.png"
    with pytest.raises(UserError, match="/etc/passwd"):
        named("/etc/passwd", given)
    with pytest.raises(UserError, match="--reference"):
        carry_out(corner, parse({"op": "restyle", "target": {"text": "table"}, "reference": "photo"}), context)
    two = {**given, "blue.png": photograph("blue.png")}
    assert named("photo 2", two).name == "blue.png"
    with pytest.raises(UserError, match="which one"):
        named("photo", two)


@pytest.mark.parametrize(
    ("more", "period"),
    [({}, 0.2), ({"width": {"value": 50, "unit": "cm"}}, 0.1), ({"unit": {"value": 25, "unit": "cm"}}, 0.25)],
)
def test_the_size_of_a_photograph(corner: Scene, context: Context, more: dict[str, Any], period: float) -> None:
    from dataclasses import replace

    given = replace(context, references={"red.png": photograph()})
    op = parse({"op": "restyle", "target": {"text": "floor"}, "reference": "photo", **more}).settled(corner, given)
    design = op._design(None, 1.0, 0)  # type: ignore[attr-defined]
    texture = design.pattern.args[0]
    assert texture.period[0] == pytest.approx(period, rel=0.01)
    assert carry_out(corner, op, given).receipt.passed
