"""Zstandard frames (RFC 8878), packed and unpacked by the system's libzstd, or stored without packing by ourselves.

Knows the C functions `ZSTD_compress` and `ZSTD_decompress` (zstd.h, stable since 1.0). Refuses to allocate more than
the caller says a frame holds. Python has Zstandard of its own only from 3.14.
"""

from __future__ import annotations

import ctypes
import ctypes.util
import functools
import struct

from ...errors import BackendError

_LEVEL = 12
_MAGIC = 0xFD2FB528
_BLOCK = 1 << 17  # the largest that RFC 8878 allows
_NEEDED = (
    "SPZ version 4 needs the library zstd; install it (Debian: apt install libzstd1, macOS: brew install zstd), "
    "or use version 3"
)


class BrokenFrameError(Exception):
    """The bytes are no sound frame of the size that was said."""


@functools.cache
def _library() -> ctypes.CDLL:
    """libzstd with typed functions.

    Raises:
        BackendError: it is not installed.
    """
    name = ctypes.util.find_library("zstd")
    try:
        library = ctypes.CDLL(name or "libzstd.so.1")
    except OSError as error:
        raise BackendError(_NEEDED) from error
    size, pointer = ctypes.c_size_t, ctypes.c_void_p
    for function, result, arguments in (
        ("ZSTD_compressBound", size, [size]),
        ("ZSTD_compress", size, [pointer, size, ctypes.c_char_p, size, ctypes.c_int]),
        ("ZSTD_decompress", size, [pointer, size, ctypes.c_char_p, size]),
        ("ZSTD_isError", ctypes.c_uint, [size]),
    ):
        getattr(library, function).restype = result
        getattr(library, function).argtypes = arguments
    return library


def available() -> bool:
    """Whether frames can be packed and unpacked here."""
    try:
        _library()
    except BackendError:
        return False
    return True


def compress(data: bytes) -> bytes:
    """One frame that holds `data`.

    Raises:
        BackendError: libzstd is not installed.
    """
    library = _library()
    room = library.ZSTD_compressBound(len(data))
    packed = ctypes.create_string_buffer(room)
    size = library.ZSTD_compress(packed, room, data, len(data), _LEVEL)
    if library.ZSTD_isError(size):
        raise BackendError(f"libzstd could not pack {len(data):,} bytes; its memory may be exhausted")
    return packed.raw[:size]


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
    """The `size` bytes in a frame; nothing larger than that is allocated, whatever the frame says.

    Raises:
        BackendError: libzstd is not installed.
        BrokenFrameError: it is no sound frame, or holds another number of bytes.
    """
    library = _library()
    data = ctypes.create_string_buffer(max(size, 1))
    got = library.ZSTD_decompress(data, size, frame, len(frame))
    if library.ZSTD_isError(got) or got != size:
        raise BrokenFrameError
    return data.raw[:size]
