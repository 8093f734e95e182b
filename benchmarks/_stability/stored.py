"""Rows of scenes that are saved and loaded again through each file format, and of broken files."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from statistics import fmean

import numpy as np
import torch
from scipy.spatial import cKDTree

from ...gaussians import files
from ...gaussians.errors import ScenewrightError
from ...gaussians.language.field.loading import load
from ...gaussians.language.field.store import save_field
from ...gaussians.render import render
from .._rows import Level, Row
from .._select.cases import Case, ask
from .edits import psnr
from .ground import Ground

FORMATS = (".ply", ".splat", ".compressed.ply", ".spz", ".sog")
CAP = 40.0  # dB from which a format shows what was saved
BROKEN = 40  # files of a row


def rows(ground: Ground) -> Iterator[Row]:
    """All of them."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        loaded = {form: [_reloaded(room, folder, form) for room in ground.rooms] for form in FORMATS}
        yield _pictures(ground, loaded)
        yield _fields(ground, folder)
        yield _broken(ground, folder)
    if not ground.quick:
        baseline = ground.miou(ground.bare)
        values = [(form, ground.miou(ground.embedded(cases))) for form, cases in loaded.items()]
        yield ground.row("file.names_after_reload", baseline, values)


def _reloaded(case: Case, folder: Path, form: str) -> Case:
    """The case as a file of a format holds it; the truth goes along with the nearest centre."""
    path = folder / f"room{case.seed}{form}"
    files.save(case.scene.replace(language=None, cameras=()), path, force=True)
    scene = files.load(path)
    _, nearest = cKDTree(case.points).query(scene.cloud.means.numpy())
    return replace(case, scene=scene.replace(cameras=case.scene.cameras), ids=case.ids[nearest])


def _pictures(ground: Ground, loaded: dict[str, list[Case]]) -> Row:
    """The first camera's picture of what was loaded against that of what was saved."""
    levels = []
    for form, cases in loaded.items():
        each = []
        for room, case in zip(ground.rooms, cases, strict=True):
            eye = room.scene.cameras[0].resized(320, 240)
            each.append(psnr(render(room.scene.cloud, eye).rgb, render(case.scene.cloud, eye).rgb, CAP))
        levels.append((form, min(each)))
    levels.sort(key=lambda pair: -pair[1])
    return ground.row("file.pictures_after_reload", CAP, levels, "dB", len(ground.rooms))


def _fields(ground: Ground, folder: Path) -> Row:
    """Selections by name after the scene and its language field are saved and loaded: the same Gaussians?"""
    case = ground.known[0]
    levels = []
    for form in FORMATS:
        path = folder / f"field{form}"
        files.save(case.scene, path, force=True)
        save_field(case.scene, path)
        again = replace(case, scene=load(path).replace(cameras=case.scene.cameras))
        same = [
            float(np.array_equal(ask(case, o.kind, ground.encoder).mask, ask(again, o.kind, ground.encoder).mask))
            for o in case.alone()
        ]
        levels.append(Level(form, fmean(same)))
    return Row("file.field_after_reload", 1.0, tuple(levels), "share the same", len(case.alone()), law=True)


def _broken(ground: Ground, folder: Path) -> Row:
    """Files cut short, with bytes exchanged, and with values that are no numbers: loaded sound, or refused in words."""
    rng = np.random.default_rng(1610)
    room = ground.rooms[0].scene
    small = room.replace(cloud=room.cloud[:500], language=None, cameras=())
    levels = []
    for form in FORMATS:
        path = folder / f"whole{form}"
        files.save(small, path, force=True)
        whole = path.read_bytes()
        good = []
        for i in range(BROKEN // 4 if ground.quick else BROKEN):
            broken = folder / f"broken{form}"
            broken.write_bytes(_spoiled(whole, rng, i))
            good.append(_sound(broken))
        levels.append(Level(form, fmean(good)))
    return Row("file.broken_files", 1.0, tuple(levels), "share sound", len(good) * len(FORMATS), law=True)


def _spoiled(whole: bytes, rng: np.random.Generator, turn: int) -> bytes:
    """One of: cut short, some bytes exchanged, a run of bytes set, doubled."""
    if turn % 4 == 0:
        return whole[: int(rng.integers(len(whole)))]
    data = bytearray(whole)
    if turn % 4 == 1:
        for at in rng.integers(len(data), size=20):
            data[at] = int(rng.integers(256))
    elif turn % 4 == 2:
        at = int(rng.integers(len(data)))
        data[at : at + 64] = b"\xff" * 64
    else:
        data += data[: int(rng.integers(len(data)))]
    return bytes(data)


def _sound(path: Path) -> float:
    """1 if a file gives a scene of finite values or an error of ours."""
    try:
        cloud = files.load(path).cloud
    except ScenewrightError:
        return 1.0
    except Exception:  # any other error is the fault that is looked for
        return 0.0
    finite = all(bool(torch.isfinite(column).all()) for _, column in cloud.columns() if column.is_floating_point())
    return float(finite and bool((cloud.scales > 0).all()))
