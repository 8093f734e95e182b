"""Rasterise triangles into a depth buffer, and look up shadows and ambient occlusion from depth buffers.

Camera space throughout: x right, y down, z forward, in metres; pixel centres at +0.5. Buffers hold the inverse depth, 0
where no triangle is.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

F32 = NDArray[np.float32]
I32 = NDArray[np.int32]
NEAR = 0.03  # metres; triangles that reach nearer are left out


@njit(cache=True, error_model="numpy")
def _fill(tri: Any, fx: float, fy: float, cx: float, cy: float, inverse: Any, face: Any, bary: Any) -> None:
    """Keep the nearest triangle of each pixel. `tri [F, 3, 3]`; the last three arguments are written."""
    height, width = inverse.shape
    for f in range(tri.shape[0]):
        za, zb, zc = tri[f, 0, 2], tri[f, 1, 2], tri[f, 2, 2]
        if za < NEAR or zb < NEAR or zc < NEAR:
            continue
        ia, ib, ic = 1.0 / za, 1.0 / zb, 1.0 / zc
        ax, ay = fx * tri[f, 0, 0] * ia + cx, fy * tri[f, 0, 1] * ia + cy
        bx, by = fx * tri[f, 1, 0] * ib + cx, fy * tri[f, 1, 1] * ib + cy
        dx, dy = fx * tri[f, 2, 0] * ic + cx, fy * tri[f, 2, 1] * ic + cy
        area = (bx - ax) * (dy - ay) - (by - ay) * (dx - ax)
        if abs(area) < 1e-9:
            continue
        left = max(0, int(np.floor(min(ax, bx, dx) - 0.5)))
        right = min(width - 1, int(np.ceil(max(ax, bx, dx) - 0.5)))
        top = max(0, int(np.floor(min(ay, by, dy) - 0.5)))
        bottom = min(height - 1, int(np.ceil(max(ay, by, dy) - 0.5)))
        for row in range(top, bottom + 1):
            py = row + 0.5
            for col in range(left, right + 1):
                px = col + 0.5
                wb = ((px - ax) * (dy - ay) - (py - ay) * (dx - ax)) / area
                wc = ((bx - ax) * (py - ay) - (by - ay) * (px - ax)) / area
                wa = 1.0 - wb - wc
                if wa < 0.0 or wb < 0.0 or wc < 0.0:
                    continue
                near = wa * ia + wb * ib + wc * ic
                if near > inverse[row, col]:
                    inverse[row, col] = near
                    face[row, col] = f
                    bary[row, col, 0] = wb * ib / near
                    bary[row, col, 1] = wc * ic / near


def rasterise(tri: F32, focal: float, width: int, height: int) -> tuple[F32, I32, F32]:
    """Inverse depth `[H, W]`, face number `[H, W]` (-1 where none) and the weights of the face's corners 1 and 2
    `[H, W, 2]`, of triangles `[F, 3, 3]` in camera space; the principal point is the middle of the picture."""
    inverse = np.zeros((height, width), np.float32)
    face = np.full((height, width), -1, np.int32)
    bary = np.zeros((height, width, 2), np.float32)
    _fill(np.ascontiguousarray(tri, np.float32), focal, focal, width / 2, height / 2, inverse, face, bary)
    return inverse, face, bary


@njit(cache=True, error_model="numpy")
def shadow(points: Any, inverse: Any, focal: float, radius: int, bias: float) -> Any:
    """Share of light `[M]` that reaches points `[M, 3]` in the lamp's camera space, past the lamp's buffer `inverse`.

    The mean over `(2 radius + 1)^2` texels makes soft borders. `bias` is a share of the depth. Points outside of the
    lamp's picture are lit.
    """
    height, width = inverse.shape
    out = np.ones(len(points), np.float32)
    for i in range(len(points)):
        z = points[i, 2]
        if z < NEAR:
            continue
        col = int(focal * points[i, 0] / z + width / 2)
        row = int(focal * points[i, 1] / z + height / 2)
        if col < radius or row < radius or col >= width - radius or row >= height - radius:
            continue
        limit = 1.0 / (z * (1.0 - bias))
        lit = 0
        for r in range(row - radius, row + radius + 1):
            for c in range(col - radius, col + radius + 1):
                if inverse[r, c] < limit:
                    lit += 1
        out[i] = lit / (2 * radius + 1) ** 2
    return out


@njit(cache=True, error_model="numpy")
def occlusion(inverse: Any, normal: Any, focal: float, reach: float, ways: Any) -> Any:
    """Ambient occlusion `[H, W]` in [0, 1]: the share of samples in a half sphere of radius `reach` metres about the
    normal that lie behind what the buffer shows (Mittring 2007). `ways [K, 3]` are unit directions; each pixel uses
    eight of them."""
    height, width = inverse.shape
    out = np.zeros((height, width), np.float32)
    for row in range(height):
        for col in range(width):
            if inverse[row, col] <= 0.0:
                continue
            z = 1.0 / inverse[row, col]
            x, y = (col + 0.5 - width / 2) * z / focal, (row + 0.5 - height / 2) * z / focal
            first = (row * 7919 + col * 104729 + (row * col) % 31) % (len(ways) - 8)
            hidden = 0
            for k in range(8):
                dx, dy, dz = ways[first + k, 0], ways[first + k, 1], ways[first + k, 2]
                s = reach * (0.1 + 0.9 * ((k + 0.5) / 8) ** 1.5)
                if dx * normal[row, col, 0] + dy * normal[row, col, 1] + dz * normal[row, col, 2] < 0:
                    s = -s
                qx, qy, qz = x + s * dx, y + s * dy, z + s * dz
                if qz < NEAR:
                    continue
                c, r = int(focal * qx / qz + width / 2), int(focal * qy / qz + height / 2)
                if c < 0 or r < 0 or c >= width or r >= height or inverse[r, c] <= 0.0:
                    continue
                front = 1.0 / inverse[r, c]
                if front < qz * 0.998 and qz - front < 2 * reach:
                    hidden += 1
            out[row, col] = hidden / 8
    return out


@njit(cache=True, error_model="numpy")
def interpolated(values: Any, faces: Any, bary: Any) -> Any:
    """Values `[M, C]` at points of faces `[M]`, from those of the corners `[F, 3, C]`; `bary [M, 2]` as above."""
    out = np.empty((len(faces), values.shape[2]), np.float32)
    for i in range(len(faces)):
        f, b, c = faces[i], bary[i, 0], bary[i, 1]
        for k in range(values.shape[2]):
            out[i, k] = (1 - b - c) * values[f, 0, k] + b * values[f, 1, k] + c * values[f, 2, k]
    return out


@njit(cache=True, error_model="numpy")
def lifted(pixels: Any, inverse: Any, focal: float) -> Any:
    """Points `[M, 3]` in camera space that flat pixel numbers `[M]` show."""
    height, width = inverse.shape
    out = np.empty((len(pixels), 3), np.float32)
    for i in range(len(pixels)):
        row, col = pixels[i] // width, pixels[i] % width
        z = 1.0 / inverse[row, col]
        out[i, 0], out[i, 1], out[i, 2] = (col + 0.5 - width / 2) * z / focal, (row + 0.5 - height / 2) * z / focal, z
    return out


@njit(cache=True, error_model="numpy")
def face_viewer(normal: Any, point: Any) -> None:
    """Scale normals `[M, 3]` to unit length and turn them towards the camera, in place."""
    for i in range(len(normal)):
        x, y, z = normal[i, 0], normal[i, 1], normal[i, 2]
        length = max(1e-6, np.sqrt(x * x + y * y + z * z))
        if x * point[i, 0] + y * point[i, 1] + z * point[i, 2] > 0:
            length = -length
        normal[i, 0], normal[i, 1], normal[i, 2] = x / length, y / length, z / length


@njit(cache=True, error_model="numpy")
def lamp(surface: Any, at: Any, strength: Any, reach: float, light: Any, shine: Any) -> None:
    """Add one lamp's diffuse light and highlights (Blinn 1977) `[M, 3]`.

    `surface` holds points and normals `[M, 3]` in camera space, exponents and lit shares `[M]`; the light falls to a
    half at `reach` metres.
    """
    point, normal, sharp, lit = surface
    for i in range(len(point)):
        lx, ly, lz = at[0] - point[i, 0], at[1] - point[i, 1], at[2] - point[i, 2]
        far = max(1e-6, np.sqrt(lx * lx + ly * ly + lz * lz))
        lx, ly, lz = lx / far, ly / far, lz / far
        diffuse = lx * normal[i, 0] + ly * normal[i, 1] + lz * normal[i, 2]
        if diffuse <= 0:
            continue
        px, py, pz = point[i, 0], point[i, 1], point[i, 2]
        away = max(1e-6, np.sqrt(px * px + py * py + pz * pz))
        hx, hy, hz = lx - px / away, ly - py / away, lz - pz / away
        half = max(1e-6, np.sqrt(hx * hx + hy * hy + hz * hz))
        bright = max(0.0, (hx * normal[i, 0] + hy * normal[i, 1] + hz * normal[i, 2]) / half) ** sharp[i]
        gain = lit[i] / (1 + (far / reach) ** 2)
        for k in range(3):
            light[i, k] += gain * diffuse * strength[k]
            shine[i, k] += gain * bright * strength[k]
