"""Pictures of a request: scaled down to the size that a model reads, in a format that it accepts; labels for several.

Servers scale larger pictures down themselves, so sending them costs time and gains nothing. Nothing is ever enlarged.
"""

from __future__ import annotations

import io
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ...gaussians.errors import UserError
from .backend import Message

if TYPE_CHECKING:
    from PIL.Image import Image

# First bytes of the formats that all three providers accept.
_STARTS = {b"\x89PNG\r\n\x1a\n": "image/png", b"\xff\xd8\xff": "image/jpeg", b"RIFF": "image/webp"}
_BASE64 = 1.4  # size of a picture in a request, against its bytes


@dataclass(frozen=True)
class Limits:
    """The largest picture that a model reads without scaling it down.

    Attributes:
        long, short: pixels of the longer and the shorter side.
        area: pixels.
        bytes: of the encoded file.
        request: bytes of all that is sent at once.
    """

    long: int
    short: int
    area: int
    bytes: int
    request: int

    def size(self, width: int, height: int) -> tuple[int, int]:
        """The largest size of the same shape within the limits, never above the given one."""
        scale = min(
            1.0,
            self.long / max(width, height),
            self.short / min(width, height),
            math.sqrt(self.area / (width * height)),
        )
        if scale >= 1.0:
            return width, height
        return max(int(width * scale), 1), max(int(height * scale), 1)


# OpenAI scales to fit 2048 x 2048, then the shorter side to 768, which is also the limit of 1536 patches of 32 x 32.
# Source: platform.openai.com/docs/guides/images-vision. Compatible servers resize too, or read less.
OPENAI = Limits(2048, 768, 2048 * 768, 20 * 10**6, 50 * 10**6)
# Anthropic: 1568 pixels, about 1.15 megapixels, 5 MB. Source: platform.claude.com/docs/en/build-with-claude/vision.
ANTHROPIC = Limits(1568, 1568, 1_150_000, 5 * 10**6, 32 * 10**6)
# Google: 3072 x 3072; a whole request of 20 MB. Source: ai.google.dev/gemini-api/docs/image-understanding.
GOOGLE = Limits(3072, 3072, 3072 * 3072, 7 * 10**6, 20 * 10**6)
# A local processor scales by itself; this only bounds the memory of processors that keep any resolution.
LOCAL = Limits(1536, 1536, 1_150_000, 10**9, 10**12)


def decoded(picture: bytes) -> Image:
    """A picture in RGB; transparent ones on white.

    Raises:
        UserError: it is no picture.
    """
    from PIL import Image

    try:
        with Image.open(io.BytesIO(picture)) as image:
            image.load()
            if image.mode in ("RGBA", "LA", "PA") or "transparency" in image.info:
                opaque = Image.new("RGBA", image.size, "white")
                opaque.alpha_composite(image.convert("RGBA"))
                return opaque.convert("RGB")
            return image.convert("RGB")
    except (OSError, ValueError, SyntaxError, Image.DecompressionBombError) as error:
        raise UserError("a picture for the model cannot be read; give PNG, JPEG or WebP") from error


def fitted(messages: Sequence[Message], limits: Limits) -> list[Message]:
    """The messages with pictures within the limits; a picture that fits is passed on byte for byte.

    Raises:
        UserError: something in `pictures` is no picture.
    """
    count = sum(len(message.pictures) for message in messages)
    most = min(limits.bytes, int(limits.request / _BASE64 / max(count, 1)))
    return [
        replace(message, pictures=tuple(_fitted(picture, limits, most) for picture in message.pictures))
        for message in messages
    ]


def media_type(picture: bytes) -> str:
    """The media type of a picture that `fitted` returned."""
    return next(kind for start, kind in _STARTS.items() if picture.startswith(start))


def _fitted(picture: bytes, limits: Limits, most: int) -> bytes:
    """A picture within the limits, of at most `most` bytes."""
    image = decoded(picture)
    known = picture.startswith(tuple(_STARTS))
    if known and limits.size(*image.size) == image.size and len(picture) <= most:
        return picture
    image = scaled_down(image, limits)
    data = _encoded(image, "PNG")
    while len(data) > most and min(image.size) > 1:
        data = _encoded(image, "JPEG", quality=90)
        image = image.resize((max(image.width * 3 // 4, 1), max(image.height * 3 // 4, 1)))
    return data


def scaled_down(image: Image, limits: Limits) -> Image:
    """An image within the limits of size; the same if it is."""
    from PIL import Image

    wanted = limits.size(*image.size)
    return image if wanted == image.size else image.resize(wanted, Image.Resampling.LANCZOS)


def _encoded(image: Image, kind: str, **options: int) -> bytes:
    out = io.BytesIO()
    image.save(out, kind, **options)
    return out.getvalue()


def parts(message: Message) -> Iterator[str | bytes]:
    """The pictures of a message, then its text; each of several pictures follows its label "Picture 1:"."""
    for number, picture in enumerate(message.pictures, 1):
        if len(message.pictures) > 1:
            yield f"Picture {number}:"
        yield picture
    yield message.text
