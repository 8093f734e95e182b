"""Half blocks: shape, colours and what is chosen for which stream."""

from __future__ import annotations

import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenewright.agent.terminal.halfblocks import depth_of, draw

_ESCAPE = re.compile(r"\x1b\[[0-9;]*m")


class _Stream:
    def __init__(self, tty: bool, encoding: str | None = "utf-8") -> None:
        self.encoding = encoding
        self._tty = tty

    def isatty(self) -> bool:
        return self._tty


@given(
    st.integers(1, 90),
    st.integers(1, 60),
    st.integers(1, 50),
    st.integers(1, 30),
    st.sampled_from(["truecolor", "256", "ascii"]),
)
def test_the_picture_fits(width: int, height: int, columns: int, rows: int, depth: str) -> None:
    image = np.random.default_rng(0).integers(0, 256, (height, width, 3), dtype=np.uint8)
    lines = _ESCAPE.sub("", draw(image, columns, rows, depth)).split("\n")  # type: ignore[arg-type]
    assert 1 <= len(lines) <= rows
    assert len({len(line) for line in lines}) == 1 and 1 <= len(lines[0]) <= columns


def test_truecolor_carries_both_pixels_exactly() -> None:
    image = np.array([[[1, 2, 3], [7, 8, 9]], [[4, 5, 6], [10, 11, 12]]], dtype=np.uint8)
    assert draw(image, 2, 1) == "\x1b[38;2;1;2;3;48;2;4;5;6m▀\x1b[38;2;7;8;9;48;2;10;11;12m▀\x1b[0m"


def test_a_colour_is_not_repeated() -> None:
    image = np.full((2, 5, 3), 200, dtype=np.uint8)
    assert draw(image, 5, 1).count("\x1b[38") == 1


@pytest.mark.parametrize(
    ("color", "code"), [((255, 0, 0), 196), ((0, 0, 0), 16), ((255, 255, 255), 231), ((128, 128, 128), 244)]
)
def test_palette_of_xterm(color: tuple[int, int, int], code: int) -> None:
    image = np.full((2, 1, 3), color, dtype=np.uint8)
    assert f"38;5;{code};48;5;{code}" in draw(image, 1, 1, "256")


def test_letters_get_denser_with_light() -> None:
    image = np.repeat(np.linspace(0, 255, 10).astype(np.uint8)[None, :, None], 2, axis=0).repeat(3, axis=2)
    text = draw(image, 10, 1, "ascii")
    assert text == " .:-=+*#%@"


@pytest.mark.parametrize(
    ("tty", "encoding", "env", "depth"),
    [
        (True, "utf-8", {"TERM": "xterm-256color", "COLORTERM": "truecolor"}, "truecolor"),
        (True, "UTF8", {"TERM": "xterm-256color"}, "256"),
        (False, "utf-8", {"TERM": "xterm-256color", "COLORTERM": "truecolor"}, "ascii"),
        (True, "utf-8", {"TERM": "dumb"}, "ascii"),
        (True, "ascii", {"TERM": "xterm"}, "ascii"),
        (True, None, {"TERM": "xterm"}, "ascii"),
        (True, "utf-8", {"TERM": "xterm", "NO_COLOR": "1"}, "ascii"),
    ],
)
def test_what_a_stream_can_show(tty: bool, encoding: str | None, env: dict[str, str], depth: str) -> None:
    assert depth_of(_Stream(tty, encoding), env) == depth
