"""Draws small numbered marks on the visible pixels of groups, with outlines in the groups' own colours.

A mark lies where most of its group surrounds it, never where something hides the group. On a thing smaller than the
mark, the mark stands beside it with a line to it. Marks do not overlap each other where there is room.
"""

from __future__ import annotations

import colorsys
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont
from scipy import ndimage

Picture = NDArray[np.uint8]  # [H, W, 3], display space
Labels = NDArray[np.int32]  # [H, W], index of the marked thing that each pixel shows, -1 for none
Color = tuple[int, int, int]

LEAST_PIXELS = 12  # of a picture 640 pixels high, from which a thing is visible and gets its mark
RADIUS = 1 / 48  # of a mark, of the picture's height
LEAST_RADIUS = 9  # pixels
SPECK = 0.02  # of a thing's pixels: pieces and holes below it are not outlined
RINGS = (1.6, 2.6, 3.8, 5.4)  # distances at which marks beside a thing are tried, in radii
WAYS = 16  # directions that are tried at each distance
COVERS = 0.15  # share of a thing that its mark may cover without cost
INK, PAPER = (24, 24, 28), (255, 255, 255)


@dataclass(frozen=True)
class Mark:
    """What is drawn on one thing.

    Attributes:
        text: its number, or a short name.
        color: of the disc or plate and of its outline, display space.
    """

    text: str
    color: Color


@dataclass(frozen=True)
class Placed:
    """Where a mark was drawn.

    Attributes:
        index: which of the marks.
        at: middle of the mark, pixels.
        anchor: pixel on the thing that the mark belongs to; the same as `at` where the mark lies on the thing.
        half: half width and half height of the mark, pixels.
    """

    index: int
    at: tuple[float, float]
    anchor: tuple[float, float]
    half: tuple[float, float]


def color_of(number: int) -> Color:
    """A strong colour for the n-th mark; neighbouring numbers differ most in hue."""
    hue = (number * 0.61803398875) % 1.0  # the golden ratio spreads hues evenly, however many there are
    r, g, b = colorsys.hls_to_rgb(hue, 0.62 if number % 2 else 0.52, 0.95)
    return round(255 * r), round(255 * g), round(255 * b)


def numbered_marks(count: int) -> tuple[Mark, ...]:
    """Marks 1 to `count`."""
    return tuple(Mark(str(i), color_of(i)) for i in range(1, count + 1))


def visible(labels: Labels, count: int) -> tuple[int, ...]:
    """Indices of the things, of `count`, that enough pixels show to be marked."""
    least = LEAST_PIXELS * max(1.0, (labels.shape[0] / 640) ** 2)
    pixels = np.bincount(labels[labels >= 0], minlength=count)
    return tuple(int(i) for i in np.flatnonzero(pixels[:count] >= least))


def draw_marks(
    image: Picture, labels: Labels, marks: Sequence[Mark], *, outlines: bool = True
) -> tuple[Picture, tuple[Placed, ...]]:
    """The picture with a mark for each visible thing.

    Args:
        image: `[H, W, 3]`.
        labels: `[H, W]`, position in `marks` of the thing that each pixel shows, -1 for none.
        marks: what is drawn on each.
        outlines: also draw each thing's border in its colour.

    Returns:
        the picture, and where the marks are, those of the smallest things first.
    """
    shown = visible(labels, len(marks))
    drawn = outlined(image, labels, [marks[i].color for i in range(len(marks))], shown) if outlines else image
    placed = place(labels, marks, shown)
    return draw_placed(drawn, marks, placed), placed


def place(labels: Labels, marks: Sequence[Mark], shown: Sequence[int]) -> tuple[Placed, ...]:
    """Positions of the marks of the things `shown`; things with the least room for a mark are placed first."""
    anchors = [_anchor(labels == i) for i in shown]
    found: list[Placed] = []
    for k in sorted(range(len(shown)), key=lambda k: anchors[k][1]):
        half = half_size(marks[shown[k]].text, labels.shape[0])
        (x, y), room = anchors[k]
        at = free_place(labels, shown[k], (x, y), room, half, found)
        found.append(Placed(shown[k], at, (x, y), half))
    return tuple(found)


def draw_placed(image: Picture, marks: Sequence[Mark], placed: Sequence[Placed]) -> Picture:
    """The picture with marks at given places: discs for numbers, plates for longer words, lines to their things."""
    canvas = Image.fromarray(np.ascontiguousarray(image))
    draw = ImageDraw.Draw(canvas)
    font = _font(image.shape[0])
    for p in placed:
        if abs(p.at[0] - p.anchor[0]) > p.half[0] or abs(p.at[1] - p.anchor[1]) > p.half[1]:
            draw.line((*p.anchor, *p.at), fill=INK, width=4)
            draw.line((*p.anchor, *p.at), fill=marks[p.index].color, width=2)
            _disc(draw, p.anchor, 3, marks[p.index].color)
    for p in placed:
        (x, y), (w, h) = p.at, p.half
        fill = marks[p.index].color
        shape = (x - w, y - h, x + w, y + h)
        draw.rounded_rectangle(shape, radius=min(w, h), fill=fill, outline=INK, width=max(1, round(h / 8)))
        light = 0.299 * fill[0] + 0.587 * fill[1] + 0.114 * fill[2] > 110
        draw.text((x, y), marks[p.index].text, fill=INK if light else PAPER, font=font, anchor="mm")
    return np.asarray(canvas)


def outline(image: Picture, mask: NDArray[np.bool_], color: Color, width: int = 2) -> Picture:
    """The picture with a line of `width` pixels in and just outside the border of a mask `[H, W]`."""
    grown = ndimage.binary_dilation(mask, iterations=max(1, width // 2))
    core = ndimage.binary_erosion(mask, iterations=max(1, width - width // 2), border_value=1)
    drawn = image.copy()
    drawn[grown & ~core] = color
    return drawn


def outlined(image: Picture, labels: Labels, colors: Sequence[Color], shown: Sequence[int]) -> Picture:
    """The picture with the borders of the things `shown`; `colors[i]` belongs to label i."""
    width = max(2, round(labels.shape[0] / 240))
    drawn = image.copy()
    for i in shown:
        mask = labels == i
        rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
        near = (
            slice(max(0, rows[0] - width), rows[-1] + width + 1),
            slice(max(0, columns[0] - width), columns[-1] + width + 1),
        )
        drawn[near] = outline(drawn[near], _smooth(mask[near]), colors[i], width)
    return drawn


def free_place(
    labels: Labels,
    own: int,
    anchor: tuple[float, float],
    room: float,
    half: tuple[float, float],
    taken: Sequence[Placed],
) -> tuple[float, float]:
    """Where a mark costs least: on its thing if that is larger than the mark, else beside it over nothing marked."""
    height, width = labels.shape
    ways = 2 * np.pi * np.arange(WAYS) / WAYS
    size = max(half)
    total = max(1, int((labels == own).sum()))
    tries = [anchor] + [
        (anchor[0] + r * size * np.cos(a), anchor[1] + r * size * np.sin(a)) for r in RINGS for a in ways
    ]
    best, least = anchor, np.inf
    for k, (x, y) in enumerate(tries):
        x = float(np.clip(x, half[0], max(half[0], width - half[0])))
        y = float(np.clip(y, half[1], max(half[1], height - half[1])))
        cost = _overlap((x, y), half, taken) * 20.0
        under = labels[max(0, int(y - half[1])) : int(y + half[1]) + 1, max(0, int(x - half[0])) : int(x + half[0]) + 1]
        cost += 3.0 * float(((under >= 0) & (under != own)).mean())
        cost += 4.0 * max(0.0, float((under == own).sum()) / total - COVERS)
        if k == 0:
            cost += 0.0 if room >= 1.2 * min(half) else 2.0 * (1 - room / (1.2 * min(half)))
        else:
            cost += 0.8 + 0.15 * float(np.hypot(x - anchor[0], y - anchor[1])) / size
        if cost < least - 1e-9:
            best, least = (x, y), cost
    return best


def half_size(text: str, height: int) -> tuple[float, float]:
    """Half width and half height of the mark for a text, pixels, in a picture of `height` pixels."""
    radius = float(max(LEAST_RADIUS, round(height * RADIUS)))
    return max(radius, _font(height).getlength(text) / 2 + 0.45 * radius), radius


def _smooth(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """A mask without the specks and holes that single Gaussians leave: pieces below `SPECK` of its pixels."""
    least = SPECK * mask.sum()
    for value in (True, False):
        pieces, count = ndimage.label(mask == value)
        if count > 1:
            small = np.bincount(pieces.ravel()) < least
            small[0] = False
            mask = mask ^ small[pieces]
    return np.asarray(mask)


def _anchor(mask: NDArray[np.bool_]) -> tuple[tuple[float, float], float]:
    """The pixel (x, y) of a mask that lies farthest within it, and its distance to the border."""
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    top, left = int(rows[0]), int(columns[0])
    inner = mask[top : rows[-1] + 1, left : columns[-1] + 1]
    distance = ndimage.distance_transform_edt(np.pad(inner, 1))[1:-1, 1:-1]
    y, x = np.unravel_index(int(np.argmax(distance)), distance.shape)
    return (left + float(x) + 0.5, top + float(y) + 0.5), float(distance[y, x])


def _overlap(at: tuple[float, float], half: tuple[float, float], taken: Sequence[Placed]) -> float:
    """Share of a mark that the marks placed so far, and the pixels they point to, cover."""
    covered = 0.0
    for p in taken:
        wide = min(at[0] + half[0], p.at[0] + p.half[0]) - max(at[0] - half[0], p.at[0] - p.half[0])
        high = min(at[1] + half[1], p.at[1] + p.half[1]) - max(at[1] - half[1], p.at[1] - p.half[1])
        covered += max(0.0, wide) * max(0.0, high)
        if abs(p.anchor[0] - at[0]) < half[0] and abs(p.anchor[1] - at[1]) < half[1]:
            covered += 0.3 * half[0] * half[1]
    return covered / (4 * half[0] * half[1])


def _disc(draw: ImageDraw.ImageDraw, at: tuple[float, float], radius: float, color: Color) -> None:
    x, y = at
    draw.ellipse((x - radius, y - radius, x + radius, y + radius), fill=color, outline=INK)


def _font(height: int) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
    return ImageFont.load_default(round(1.35 * max(LEAST_RADIUS, height * RADIUS)))
