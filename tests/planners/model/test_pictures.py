"""Pictures of a request: as large as the model reads, never larger, never enlarged, and in a format that it accepts."""

from __future__ import annotations

import io
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from loopback import png
from PIL import Image

from scenewright.gaussians.errors import UserError
from scenewright.planners.model import pictures
from scenewright.planners.model.backend import Message

ALL = (pictures.OPENAI, pictures.ANTHROPIC, pictures.GOOGLE, pictures.LOCAL)
SIDES = st.integers(1, 9000)


def sent(data: bytes, limits: pictures.Limits) -> bytes:
    ((one,),) = (m.pictures for m in pictures.fitted([Message("user", "look", (data,))], limits))
    return one


@given(SIDES, SIDES, st.sampled_from(ALL))
def test_sizes_stay_within_the_limits_and_keep_their_shape(width: int, height: int, limits: pictures.Limits) -> None:
    w, h = limits.size(width, height)
    assert 1 <= w <= width and 1 <= h <= height  # never enlarged
    assert max(w, h) <= limits.long and min(w, h) <= limits.short
    assert w * h <= limits.area or min(w, h) == 1
    if (w, h) != (width, height):
        assert abs(w - width * h / height) <= max(1, width / height)  # each side is rounded down by up to one pixel


@pytest.mark.parametrize(
    ("limits", "size", "wanted"),
    [
        (pictures.OPENAI, (1024, 768), (1024, 768)), (pictures.OPENAI, (1600, 1200), (1024, 768)),
        (pictures.OPENAI, (4096, 1024), (2048, 512)), (pictures.ANTHROPIC, (1092, 1092), (1072, 1072)),
        (pictures.ANTHROPIC, (3136, 784), (1568, 392)), (pictures.GOOGLE, (4000, 3000), (3072, 2304)),
        (pictures.GOOGLE, (768, 768), (768, 768)),
    ],
)  # fmt: skip
def test_documented_sizes(limits: pictures.Limits, size: tuple[int, int], wanted: tuple[int, int]) -> None:
    assert limits.size(*size) == wanted


def test_a_picture_that_fits_is_passed_on_byte_for_byte() -> None:
    data = png(300, 200)
    assert all(sent(data, limits) is data for limits in ALL)


def test_a_large_picture_is_scaled_down_and_shows_the_same() -> None:
    image = Image.new("RGB", (4000, 2000), "red")
    image.paste((0, 0, 255), (2000, 0, 4000, 2000))
    out = io.BytesIO()
    image.save(out, "PNG")
    small = Image.open(io.BytesIO(sent(out.getvalue(), pictures.OPENAI)))
    assert small.size == (1536, 768) and small.format == "PNG"
    assert small.getpixel((100, 300)) == (255, 0, 0) and small.getpixel((1400, 300)) == (0, 0, 255)


def test_bytes_are_limited_for_each_picture_and_for_the_whole_request() -> None:
    noise = png(700, 700)  # about 1.5 MB
    tight = replace(pictures.GOOGLE, bytes=200_000)
    small = sent(noise, tight)
    assert len(small) <= 200_000 and pictures.media_type(small) == "image/jpeg"
    whole = replace(pictures.GOOGLE, request=1_000_000)
    (message,) = pictures.fitted([Message("user", "", (noise,) * 4)], whole)
    assert sum(map(len, message.pictures)) <= 1_000_000 / 1.33


@pytest.mark.parametrize("form", ["GIF", "BMP", "TIFF"])
def test_other_formats_become_png(form: str) -> None:
    out = io.BytesIO()
    Image.new("RGB", (20, 10), "green").save(out, form)
    assert pictures.media_type(sent(out.getvalue(), pictures.ANTHROPIC)) == "image/png"


@pytest.mark.parametrize("form", ["JPEG", "WEBP", "PNG"])
def test_formats_that_servers_take_are_kept(form: str) -> None:
    out = io.BytesIO()
    Image.new("RGB", (20, 10), "green").save(out, form)
    assert sent(out.getvalue(), pictures.ANTHROPIC) == out.getvalue()
    assert pictures.media_type(out.getvalue()) == f"image/{form.lower()}"


def test_what_is_transparent_is_white() -> None:
    out = io.BytesIO()
    Image.new("RGBA", (4, 4), (255, 0, 0, 0)).save(out, "PNG")
    assert np.asarray(pictures.decoded(out.getvalue())).min() == 255


@pytest.mark.parametrize("data", [b"", b"no picture", b"\x89PNG\r\n\x1a\n", png(40, 40)[:200]])
def test_what_is_no_picture_is_told(data: bytes) -> None:
    with pytest.raises(UserError, match="cannot be read"):
        sent(data, pictures.OPENAI)


def test_several_pictures_are_labelled_and_one_is_not() -> None:
    one, other = png(4, 4), png(4, 4, 1)
    assert list(pictures.parts(Message("user", "look", (one,)))) == [one, "look"]
    assert list(pictures.parts(Message("user", "look", (one, other)))) == [
        "Picture 1:", one, "Picture 2:", other, "look",
    ]  # fmt: skip
