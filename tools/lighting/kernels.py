"""Kernels of relighting: colours of Gaussians under another light, what points receive from lamps, and shadows."""

from __future__ import annotations

import math

import numpy as np

from ...gaussians.compiled import helper, kernel

f4 = np.float32
C0, HALF, ZERO, ONE = f4(0.28209479177387814), f4(0.5), f4(0), f4(1)
RED, GREEN, BLUE = f4(0.2126), f4(0.7152), f4(0.0722)
EXPONENT = f4(1 / 2.2)  # light times k shows as display values times k^(1/2.2): a display's transfer as a power law
_DARK = f4(0.03)  # display luma below which contrast changes no more
_TINY = f4(1e-6)
_WRAP = f4(0.3)  # share of a lamp's light that reaches a surface whatever it faces: it is reflected by the room
_STEPS = 96  # cells at most from a point to a lamp


@kernel
def relight(worker, count, rows, sh, light, matrix, tone, out):  # type: ignore[no-untyped-def]
    """Write the harmonics of some Gaussians under another light.

    Args:
        rows: `[M]` int64.
        sh: `[N, K, 3]` before.
        light: `[M, 3]` or `[1, 3]` factors of linear light.
        matrix: `[3, 3]` map of display colours.
        tone: `[4]` gain of display values, exponent of contrast less one, its pivot, and the knee.
        out: `[N, K, 3]`, rows of it are written.
    """
    gain, power, pivot, knee = tone[0], tone[1], tone[2], tone[3]
    each = 1 if light.shape[0] > 1 else 0
    uniform_r = gain * light[0, 0] ** EXPONENT
    uniform_g = gain * light[0, 1] ** EXPONENT
    uniform_b = gain * light[0, 2] ** EXPONENT
    first, last = worker * len(rows) // count, (worker + 1) * len(rows) // count
    for i in range(first, last):
        n = rows[i]
        fr, fg, fb = uniform_r, uniform_g, uniform_b
        if each:
            fr, fg, fb = gain * light[i, 0] ** EXPONENT, gain * light[i, 1] ** EXPONENT, gain * light[i, 2] ** EXPONENT
        r, g, b = C0 * sh[n, 0, 0] + HALF, C0 * sh[n, 0, 1] + HALF, C0 * sh[n, 0, 2] + HALF
        if power != ZERO:
            luma = min(max(RED * r + GREEN * g + BLUE * b, ZERO), ONE)
            steeper = ((luma + _DARK) / (pivot + _DARK)) ** power
            fr, fg, fb = fr * steeper, fg * steeper, fb * steeper
        tr = fr * (matrix[0, 0] * r + matrix[0, 1] * g + matrix[0, 2] * b)
        tg = fg * (matrix[1, 0] * r + matrix[1, 1] * g + matrix[1, 2] * b)
        tb = fb * (matrix[2, 0] * r + matrix[2, 1] * g + matrix[2, 2] * b)
        top, was = max(tr, tg, tb), max(r, g, b)
        scale = ONE
        if top > knee and top > was:
            scale = _shoulder(was, top / max(was, _TINY), knee) / top
        fr, fg, fb = scale * fr, scale * fg, scale * fb
        for k in range(sh.shape[1]):
            x, y, z = sh[n, k, 0], sh[n, k, 1], sh[n, k, 2]
            out[n, k, 0] = fr * (matrix[0, 0] * x + matrix[0, 1] * y + matrix[0, 2] * z)
            out[n, k, 1] = fg * (matrix[1, 0] * x + matrix[1, 1] * y + matrix[1, 2] * z)
            out[n, k, 2] = fb * (matrix[2, 0] * x + matrix[2, 1] * y + matrix[2, 2] * z)
        out[n, 0, 0] = (scale * tr - HALF) / C0
        out[n, 0, 1] = (scale * tg - HALF) / C0
        out[n, 0, 2] = (scale * tb - HALF) / C0


@helper
def _shoulder(was, ratio, knee):  # type: ignore[no-untyped-def]
    """The display value that `was` becomes if a factor `ratio` > 1 is rolled off above the knee: smooth, rising, and 1
    stays 1; what was brighter stays."""
    if was >= ONE:
        return was
    start = knee / ratio
    if was <= start:
        return ratio * was
    slope = ratio * (ONE - start) / (ONE - knee)
    way = (was - start) / (ONE - start)
    return knee + (ONE - knee) * slope * way / (ONE + (slope - ONE) * way)


@helper
def _read(block, step, low, x, y, z, where):  # type: ignore[no-untyped-def]
    """Write the trilinear weights of a point to `where` `[6]`: lower indices and fractions along x, y and z."""
    for axis in range(3):
        value = x if axis == 0 else (y if axis == 1 else z)
        at = (value - low[axis]) / step - HALF
        at = min(max(at, ZERO), f4(block[axis] - 1) - f4(1e-3))
        where[axis] = math.floor(at)
        where[3 + axis] = at - where[axis]


@helper
def _mixed(values, s, shape, where):  # type: ignore[no-untyped-def]
    """Trilinear value of row `s` of a block `[S, cells]` at `where`."""
    i, j, k = int(where[0]), int(where[1]), int(where[2])
    total = ZERO
    for a in range(2):
        wa = where[3] if a else ONE - where[3]
        for b in range(2):
            wb = where[4] if b else ONE - where[4]
            for c in range(2):
                wc = where[5] if c else ONE - where[5]
                total += wa * wb * wc * values[s, ((i + a) * shape[1] + j + b) * shape[2] + k + c]
    return total


@kernel
def receive(  # type: ignore[no-untyped-def]
    worker, count, rows, means, quats, scales, grid, shape, normals, seen, sources, sky, out, where
):
    """Write what Gaussians receive: the light that was there, changed by where it comes from, and that of lamps.

    Args:
        rows: `[M]` int64.
        means, quats, scales: of the cloud.
        grid: `[4]` lower corner and side of the cells.
        shape: `[3]` int64 cells along the axes.
        normals: `[3, cells]` smoothed normals, any length up to 1, away from what is solid.
        seen: `[S, cells]` share of each lamp's light that arrives.
        sources: `[S, 9]` position, intensity at a unit's distance in red, green and blue, squared radius, reach, and
            0; a negative intensity divides instead (a lamp that goes out).
        sky: `[8]` direction to the light `[3]`, strength by facing, strength by place, centre of the scene along the
            direction, half its extent, and the factor of what was there.
        out: `[M, 3]` factors of linear light.
        where: `[workers, 6]`, scratch.
    """
    low, step = grid[:3], grid[3]
    at = where[worker]
    first, last = worker * len(rows) // count, (worker + 1) * len(rows) // count
    for i in range(first, last):
        n = rows[i]
        x, y, z = means[n, 0], means[n, 1], means[n, 2]
        _read(shape, step, low, x, y, z, at)
        nx, ny, nz = _mixed(normals, 0, shape, at), _mixed(normals, 1, shape, at), _mixed(normals, 2, shape, at)
        ox, oy, oz = _thin_axis(quats, scales, n)
        flat = _flatness(scales, n)
        side = ONE if ox * nx + oy * ny + oz * nz >= ZERO else -ONE
        nx, ny, nz = nx + flat * side * ox, ny + flat * side * oy, nz + flat * side * oz
        inverse = ONE / math.sqrt(nx * nx + ny * ny + nz * nz + f4(0.02))
        nx, ny, nz = nx * inverse, ny * inverse, nz * inverse
        facing = nx * sky[0] + ny * sky[1] + nz * sky[2]
        place = (x * sky[0] + y * sky[1] + z * sky[2] - sky[5]) / sky[6]
        base = sky[7] * max(ONE + sky[3] * facing + sky[4] * min(max(place, -ONE), ONE), f4(0.1))
        red, green, blue = base, base, base
        off_r, off_g, off_b = ONE, ONE, ONE
        for s in range(sources.shape[0]):
            dx, dy, dz = sources[s, 0] - x, sources[s, 1] - y, sources[s, 2] - z
            square = dx * dx + dy * dy + dz * dz
            if square > sources[s, 7]:
                continue
            away = math.sqrt(square) + _TINY
            toward = max((nx * dx + ny * dy + nz * dz) / away, ZERO)
            light = (_WRAP + (ONE - _WRAP) * toward) * _mixed(seen, s, shape, at) / (square + sources[s, 6])
            light *= ONE - (square / sources[s, 7]) ** 2
            if sources[s, 3] < ZERO:
                off_r *= ONE / (ONE - light * sources[s, 3])
                off_g *= ONE / (ONE - light * sources[s, 4])
                off_b *= ONE / (ONE - light * sources[s, 5])
            else:
                red += light * sources[s, 3]
                green += light * sources[s, 4]
                blue += light * sources[s, 5]
        out[i, 0], out[i, 1], out[i, 2] = off_r * red, off_g * green, off_b * blue


@helper
def _thin_axis(quats, scales, n):  # type: ignore[no-untyped-def]
    """The shortest axis of a Gaussian, world frame."""
    w, x, y, z = quats[n, 0], quats[n, 1], quats[n, 2], quats[n, 3]
    a, b, c = scales[n, 0], scales[n, 1], scales[n, 2]
    two = f4(2)
    if a <= b and a <= c:
        return ONE - two * (y * y + z * z), two * (x * y + w * z), two * (x * z - w * y)
    if b <= c:
        return two * (x * y - w * z), ONE - two * (x * x + z * z), two * (y * z + w * x)
    return two * (x * z + w * y), two * (y * z - w * x), ONE - two * (x * x + y * y)


@helper
def _flatness(scales, n):  # type: ignore[no-untyped-def]
    """How much a Gaussian is a disc: 0 for a ball or a needle, 1 for a thin disc."""
    a, b, c = scales[n, 0], scales[n, 1], scales[n, 2]
    least, most = min(min(a, b), c), max(max(a, b), c)
    middle = a + b + c - least - most + f4(1e-12)
    thin, long = least / middle, middle / (most + f4(1e-12))
    return max(ONE - f4(2.5) * thin, ZERO) * min(f4(2) * long, ONE)


@kernel
def visible(worker, count, cells, solid, grid, shape, sources, clear, seen):  # type: ignore[no-untyped-def]
    """Write to `seen` `[S, cells]` the share of each lamp's light that reaches some cells.

    Args:
        cells: `[C]` int64 flat indices of the cells that hold something.
        solid: `[cells]` how much of the light through a cell is stopped, 0 to 1.
        sources: as `receive` takes them.
        clear: cells at both ends of a ray that stop nothing.
    """
    step = grid[3]
    first, last = worker * len(cells) // count, (worker + 1) * len(cells) // count
    for i in range(first, last):
        cell = cells[i]
        ci, cj, ck = cell // (shape[1] * shape[2]), (cell // shape[2]) % shape[1], cell % shape[2]
        for s in range(sources.shape[0]):
            gi = (sources[s, 0] - grid[0]) / step - HALF
            gj = (sources[s, 1] - grid[1]) / step - HALF
            gk = (sources[s, 2] - grid[2]) / step - HALF
            di, dj, dk = gi - f4(ci), gj - f4(cj), gk - f4(ck)
            away = math.sqrt(di * di + dj * dj + dk * dk)
            share = ONE
            if away > f4(2) * clear:
                steps = min(int(away), _STEPS)
                for t in range(steps):
                    along = clear + (away - f4(2) * clear) * (f4(t) + HALF) / f4(steps)
                    part = along / away
                    i2, j2 = int(f4(ci) + part * di + HALF), int(f4(cj) + part * dj + HALF)
                    k2 = int(f4(ck) + part * dk + HALF)
                    if 0 <= i2 < shape[0] and 0 <= j2 < shape[1] and 0 <= k2 < shape[2]:
                        share *= ONE - solid[(i2 * shape[1] + j2) * shape[2] + k2]
                    if share < f4(0.02):
                        break
            seen[s, cell] = share
