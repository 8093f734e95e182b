"""Compare filled pictures with the truth inside the hole, and fill a picture by itself for comparison."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage, sparse
from scipy.sparse.linalg import spsolve

from ...gaussians.camera import Camera
from ...gaussians.cloud import GaussianCloud
from ...gaussians.render import render
from .rooms import Deletion

F64 = NDArray[np.float64]
Mask = NDArray[np.bool_]

WIDTH, HEIGHT = 240, 180
SIDES = 6  # azimuths
_ELEVATIONS = (28.0, 50.0)
_AWAY = 2.0  # times the thing's extent, and at least a metre
_OPEN = 0.5  # alpha below which a pixel of the hole is open
_CAP = 60.0  # dB


@dataclass(frozen=True)
class Scores:
    """Over all views of a deletion, in the pixels that the thing hid.

    Attributes:
        psnr: dB of the mean squared error over all these pixels.
        ssim: mean over them.
        open: share of them with alpha below one half.
    """

    psnr: float
    ssim: float
    open: float


def views(case: Deletion) -> list[Camera]:
    """Views of a thing's place from all sides, from within the room."""
    w, d, h = case.size
    away = max(1.0, _AWAY * case.extent)
    found = []
    for k in range(SIDES):
        turn, up = 2 * np.pi * (k + 0.25) / SIDES, np.radians(_ELEVATIONS[k % 2])
        eye = case.middle + away * np.array([np.cos(up) * np.cos(turn), np.cos(up) * np.sin(turn), np.sin(up)])
        eye = np.clip(eye, [-w / 2 + 0.15, -d / 2 + 0.15, 0.3], [w / 2 - 0.15, d / 2 - 0.15, h - 0.2])
        if np.linalg.norm(eye - case.middle) > 0.6 * case.extent + 0.1:
            found.append(Camera.look_at(eye, case.middle, (0, 0, 1), WIDTH, HEIGHT, 55.0, f"side {k}"))
    return found


@dataclass(frozen=True, eq=False)
class View:
    """A view of a deletion: the true picture, that after deleting alone, and the hole in it."""

    camera: Camera
    truth: F64
    bare: F64
    bare_alpha: F64
    hidden: Mask


def views_of(case: Deletion) -> list[View]:
    """The views in which the thing hid something that is there."""
    found = []
    rest, thing = case.before.cloud[~case.gone], case.before.cloud[case.gone]
    solo = thing.replace(group=thing.group * 0 + 1)
    marked = case.before.cloud.replace(group=case.gone.to(case.before.cloud.group.dtype))
    for camera in views(case):
        truth = render(case.truth, camera)
        before = render(marked, camera)
        alone = render(solo, camera).alpha.numpy()
        hidden = (before.group.numpy() == 1) & (alone > 0.5) & (truth.alpha.numpy() > 0.9)
        if hidden.sum() < 40:
            continue
        bare = render(rest, camera)
        found.append(View(camera, _rgb(truth.rgb), _rgb(bare.rgb), bare.alpha.numpy().astype(np.float64), hidden))
    return found


def _rgb(image: object) -> F64:
    array: F64 = np.clip(np.asarray(image, dtype=np.float64), 0, 1)
    return array


def scored(seen: list[View], pictures: list[F64], alphas: list[F64] | None = None) -> Scores:
    """Scores of a picture for each view."""
    square, pixels, alike, open_ = 0.0, 0, 0.0, 0
    for k, (view, picture) in enumerate(zip(seen, pictures, strict=True)):
        count = int(view.hidden.sum())
        square += float(((picture - view.truth)[view.hidden] ** 2).mean(axis=1).sum())
        alike += float(ssim_map(picture, view.truth)[view.hidden].sum())
        open_ += 0 if alphas is None else int((alphas[k][view.hidden] < _OPEN).sum())
        pixels += count
    mean = square / max(pixels, 1)
    return Scores(min(_CAP, -10 * np.log10(max(mean, 1e-9))), alike / max(pixels, 1), open_ / max(pixels, 1))


def drawn(cloud: GaussianCloud, seen: list[View]) -> tuple[list[F64], list[F64]]:
    """The pictures of a cloud from the views, and their alpha."""
    shots = [render(cloud, view.camera) for view in seen]
    return [_rgb(s.rgb) for s in shots], [s.alpha.numpy().astype(np.float64) for s in shots]


def ssim_map(a: F64, b: F64) -> F64:
    """`[H, W]` structural similarity of two pictures, mean over channels (Wang et al. 2004, sigma 1.5)."""

    def smooth(x: F64) -> F64:
        return np.asarray(ndimage.gaussian_filter(x, (1.5, 1.5, 0)))

    ma, mb = smooth(a), smooth(b)
    va, vb, both = smooth(a * a) - ma**2, smooth(b * b) - mb**2, smooth(a * b) - ma * mb
    c1, c2 = 0.01**2, 0.03**2
    return np.asarray(((2 * ma * mb + c1) * (2 * both + c2) / ((ma**2 + mb**2 + c1) * (va + vb + c2))).mean(axis=2))


def biharmonic(picture: F64, hole: Mask) -> F64:
    """The picture with the hole filled by the biharmonic equation, as `skimage.restoration.inpaint_biharmonic` does."""
    out = picture.copy()
    if not hole.any() or hole.all():
        return out
    h, w = hole.shape
    eye_h, eye_w = sparse.identity(h), sparse.identity(w)

    def second(n: int) -> sparse.spmatrix:
        d = sparse.diags([1.0, -2.0, 1.0], [-1, 0, 1], (n, n)).tolil()
        d[0, 0] = d[n - 1, n - 1] = -1.0
        return d.tocsr()

    laplace = sparse.kron(second(h), eye_w) + sparse.kron(eye_h, second(w))
    table = (laplace.T @ laplace).tocsr()
    inside = hole.ravel()
    values = picture.reshape(-1, 3)
    right = -(table[inside][:, ~inside] @ values[~inside])
    solved = spsolve(table[inside][:, inside].tocsc(), right)
    out.reshape(-1, 3)[inside] = np.clip(solved, 0, 1)
    return out


def telea(picture: F64, hole: Mask, radius: int = 5) -> F64:
    """The picture with the hole filled from its border inward, each pixel by weighted known neighbours with their
    gradients (after Telea 2004, without the level-line term)."""
    out, known = picture.copy(), ~hole
    away = ndimage.distance_transform_edt(hole)
    order = np.argsort(away, axis=None, kind="stable")
    ys, xs = np.unravel_index(order[away.ravel()[order] > 0], hole.shape)
    h, w = hole.shape
    for y, x in zip(ys, xs, strict=True):
        a, b, c, d = max(0, y - radius), min(h, y + radius + 1), max(0, x - radius), min(w, x + radius + 1)
        there = known[a:b, c:d]
        if there.any():
            yy, xx = np.mgrid[a:b, c:d]
            weight = there / ((yy - y) ** 2 + (xx - x) ** 2 + 1e-9)
            weight *= 1 / (1 + np.abs(away[a:b, c:d] - away[y, x]))
            out[y, x] = (out[a:b, c:d] * weight[..., None]).sum(axis=(0, 1)) / weight.sum()
            known[y, x] = True
    return out
