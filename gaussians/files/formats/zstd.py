"""Packs and unpacks Zstandard frames (RFC 8878) of a known size, and stores bytes in a frame without packing them.

`zstandard` does the packing. This module adds what it does not check: the size that a frame declares, before that much
memory is allocated, and bytes after the frame.
"""

from __future__ import annotations

import struct

import zstandard

_LEVEL = 12
_MAGIC = 0xFD2FB528
_BLOCK = 1 << 17  # the largest that RFC 8878 allows
_WINDOW = 8 << 20  # RFC 8878, 3.1.1.1.2: the window that every decoder is recommended to support


class BrokenFrameError(Exception):
    """The bytes are not a valid frame of the expected size."""


def compress(data: bytes) -> bytes:
    """One frame that holds `data`."""
    return zstandard.ZstdCompressor(level=_LEVEL).compress(data)


def store(data: bytes) -> bytes:
    """One frame that holds `data` as it is, in raw blocks (RFC 8878, 3.1.1)."""
    head = struct.pack("<IBQ", _MAGIC, 0b11100000, len(data))  # single segment, size in eight bytes
    starts = range(0, len(data), _BLOCK) or range(1)
    blocks = [data[start : start + _BLOCK] for start in starts]
    last = [False] * (len(blocks) - 1) + [True]
    return head + b"".join(
        struct.pack("<I", len(block) << 3 | end)[:3] + block for block, end in zip(blocks, last, strict=True)
    )


def decompress(frame: bytes, size: int) -> bytes:
    """The `size` bytes in `frame`. No larger output is allocated, whatever size the frame declares.

    Raises:
        BrokenFrameError: it is not exactly one sound frame, or it holds another number of bytes.
    """
    try:
        if zstandard.frame_content_size(frame) not in (size, -1):  # -1: the frame declares none
            raise BrokenFrameError
        unpacker = zstandard.ZstdDecompressor(max_window_size=max(size, _WINDOW))
        data = unpacker.decompress(frame, max_output_size=size, allow_extra_data=False)
    except zstandard.ZstdError as error:
        raise BrokenFrameError from error
    if len(data) != size:
        raise BrokenFrameError
    return data
