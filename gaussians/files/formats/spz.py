"""Reads SPZ (Niantic) of versions 1 to 4 and writes versions 2 to 4: one compressed byte stream per attribute.

Containers (github.com/nianticlabs/spz, README "File Format" and extensions/README.md): up to version 3 one gzip stream
with a header of 16 bytes, in version 4 a plain header of 32, extension records, a table of contents and one Zstandard
frame per attribute. `spz_codes` quantises the attributes.
At most ten times the file's size (or `FREE` bytes) is decompressed, so no file can exhaust the memory.
"""

from __future__ import annotations

import struct
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

import numpy as np

from ...errors import FileError, UserError
from ...scene import Scene
from ..format import Format, Report
from . import spz_codes as codes
from . import values, zstd

NAME = "Niantic SPZ"
LATEST = 4
WRITABLE = (2, 3, 4)
RATIO, FREE = 10, 16 << 20  # unpacked bytes that a file justifies: times its size, and whatever its size
_MAGIC = 0x5053474E  # "NGSP"
_GZIP = b"\x1f\x8b"
_LEGACY, _HEADER, _ENTRY = struct.Struct("<IIIBBBB"), struct.Struct("<IIIBBBBI12x"), struct.Struct("<QQ")
_EXTENDED = 0x2  # flag
_AXES = 0xADBE0003  # extension SPZ_ADOBE_coordinate_system
# The values of that extension that are right-handed, with the signs of their axes against right-down-forward.
_SYSTEMS: dict[int, codes.Signs] = {0: (1, -1, -1), 1: (-1, 1, -1), 4: (1, -1, -1), 6: (1, 1, 1), 7: (-1, -1, 1)}
_COEFFICIENTS = (0, 3, 8, 15, 24)  # above the constant one, by degree
_DEGREE = 3  # the highest that a cloud holds


@dataclass(frozen=True)
class _Header:
    version: int
    count: int
    degree: int
    fraction: int
    flags: int
    signs: codes.Signs = codes.RIGHT_UP_BACK

    @property
    def widths(self) -> tuple[int, ...]:
        """Bytes per Gaussian of positions, opacities, colours, scales, rotations and harmonics."""
        return (6 if self.version == 1 else 9, 1, 3, 3, 3 if self.version < 3 else 4, 3 * _COEFFICIENTS[self.degree])


def recognises(path: Path, head: bytes) -> bool:
    """Whether the content starts with the magic number, plain or inside a gzip stream."""
    if head[:2] == _GZIP:
        try:
            head = zlib.decompressobj(31).decompress(head[:4096], 4)
        except zlib.error:
            return False
    return head[:4] == b"NGSP"


def read(path: Path) -> tuple[Scene, Report]:
    """Read the scene.

    Raises:
        FileError: cut off, damaged, of an unknown version or axes, without Gaussians, or unpacking to far more than
            its size justifies.
    """
    data = path.read_bytes()
    header, streams = _unzip(path, data) if data[:2] == _GZIP else _unframe(path, data)
    arrays = [
        np.frombuffer(stream, np.uint8).reshape(header.count, width)
        for stream, width in zip(streams, header.widths, strict=True)
    ]
    packed, alphas, rgb, logs, quats, rest = arrays
    signs = header.signs
    means = (
        codes.half_positions(packed, signs) if header.version == 1 else codes.positions(packed, header.fraction, signs)
    )
    kept = 3 * _COEFFICIENTS[min(header.degree, _DEGREE)]
    sh = np.concatenate([codes.colors(rgb)[:, None], codes.harmonics(rest[:, :kept], signs)], axis=1)
    cloud, notes = values.sound_cloud(
        means, codes.rotations(quats, signs), codes.scales(logs), values.opacities_from_bytes(alphas[:, 0]), sh
    )
    if header.degree > _DEGREE:
        notes += ("harmonics of degree 4 were left out: scenes hold degree 3",)
    return Scene(cloud, path=path), Report(f"{NAME} {header.version}", header.count, len(cloud), notes)


def _checked(path: Path, header: _Header, size: int) -> _Header:
    """The header, after checking that a file of `size` bytes can hold what it declares."""
    if header.degree >= len(_COEFFICIENTS):
        raise FileError(f"{path}: harmonics of degree {header.degree}; SPZ knows 0 to {len(_COEFFICIENTS) - 1}")
    if header.fraction > 24:
        raise FileError(f"{path}: {header.fraction} fractional bits in numbers of 24; the file is damaged")
    if header.count == 0:
        raise FileError(f"{path}: the file holds zero Gaussians")
    if header.count * sum(header.widths) > max(FREE, RATIO * size):
        raise FileError(f"{path}: {header.count:,} Gaussians cannot be held in {size:,} bytes")
    return header


def _unzip(path: Path, data: bytes) -> tuple[_Header, list[bytes]]:
    """Header and streams of a file of version 1 to 3."""
    inflater = zlib.decompressobj(31)
    try:
        head = inflater.decompress(data, _LEGACY.size)
        if len(head) < _LEGACY.size:
            raise FileError(f"{path}: the SPZ file ends inside its header; it is cut off")
        magic, version, count, degree, fraction, flags, _ = _LEGACY.unpack(head)
        if magic != _MAGIC or version not in (1, 2, 3):
            raise FileError(f"{path}: not the gzip stream of an SPZ file of version 1 to 3")
        header = _checked(path, _Header(version, count, degree, fraction, flags), len(data))
        wanted = count * sum(header.widths)
        body = inflater.decompress(inflater.unconsumed_tail, wanted)
        while not inflater.eof and inflater.unconsumed_tail:  # what follows is not ours, but its checksum is
            inflater.decompress(inflater.unconsumed_tail, 1 << 16)
        inflater.flush()
    except zlib.error as error:
        raise FileError(f"{path}: the gzip stream of the SPZ file is damaged ({error})") from error
    if len(body) < wanted or not inflater.eof:
        raise FileError(f"{path}: the header promises {count:,} Gaussians, the file ends before; it is cut off")
    ends = np.cumsum([count * width for width in header.widths]).tolist()
    return header, [body[start:end] for start, end in zip([0, *ends], ends, strict=False)]


def _unframe(path: Path, data: bytes) -> tuple[_Header, list[bytes]]:
    """Header and streams of a file of version 4."""
    if len(data) < _HEADER.size:
        raise FileError(f"{path}: not an SPZ file, or one that ends inside its header")
    magic, version, count, degree, fraction, flags, streams, table = _HEADER.unpack_from(data)
    if magic != _MAGIC:
        raise FileError(f"{path}: not an SPZ file")
    if version != LATEST:
        raise FileError(f"{path}: SPZ version {version} is not known; versions 1 to {LATEST} are read")
    signs = _axes(path, data[_HEADER.size : table]) if flags & _EXTENDED else codes.RIGHT_UP_BACK
    header = _checked(path, _Header(version, count, degree, fraction, flags, signs), len(data))
    used = len(header.widths) if degree else len(header.widths) - 1
    if streams < used or not _HEADER.size <= table <= len(data) - streams * _ENTRY.size:
        raise FileError(f"{path}: the table of the SPZ file's {streams} streams is damaged or cut off")
    start, found = table + streams * _ENTRY.size, []
    for index, width in enumerate(header.widths[:used]):
        packed, unpacked = _ENTRY.unpack_from(data, table + index * _ENTRY.size)
        if unpacked != count * width or packed > len(data) - start:
            raise FileError(f"{path}: stream {index} of the SPZ file does not fit {count:,} Gaussians; it is cut off")
        try:
            found.append(zstd.decompress(data[start : start + packed], unpacked))
        except zstd.BrokenFrameError as error:
            raise FileError(f"{path}: stream {index} of the SPZ file is damaged") from error
        start += packed
    return header, found if degree else [*found, b""]


def _axes(path: Path, records: bytes) -> codes.Signs:
    """Signs of the axes from the extension records `[type u32, length u32, bytes]`; other records are skipped."""
    at = 0
    while at + 8 <= len(records):
        kind, length = struct.unpack_from("<II", records, at)
        if kind == _AXES and length >= 4 and at + 12 <= len(records):
            (system,) = struct.unpack_from("<I", records, at + 8)
            if system not in _SYSTEMS:
                raise FileError(
                    f"{path}: its axes (SPZ coordinate system {system}) are mirrored or turned; save it again"
                )
            return _SYSTEMS[system]
        at += 8 + length
    return codes.RIGHT_UP_BACK


def write(scene: Scene, file: BinaryIO, version: int = LATEST) -> None:
    """Write the scene in row order.

    Raises:
        UserError: a position lies farther out than 24 bits reach, or `version` cannot be written.
    """
    if version not in WRITABLE:
        raise UserError(f"SPZ is written in version {', '.join(map(str, WRITABLE))}, not {version}")
    cloud = values.columns(scene.cloud)
    fraction = codes.fraction_bits(cloud["means"])
    if fraction < 0:
        raise UserError("a Gaussian lies farther than 8,388,607 units out, which SPZ cannot hold; crop the scene first")
    header = _Header(version, len(scene.cloud), scene.cloud.degree, fraction, 0)
    arrays = (
        codes.pack_positions(cloud["means"], fraction),
        values.codes(cloud["opacities"], 255).astype(np.uint8),
        codes.pack_colors(cloud["sh"][:, 0]),
        codes.pack_scales(cloud["scales"]),
        codes.pack_rotations(cloud["quats"], header.widths[4]),
        codes.pack_harmonics(cloud["sh"][:, 1:]),
    )
    streams = [array.tobytes() for array in arrays if array.size]
    file.write(_frames(header, streams) if version == LATEST else _gzip(header, streams))


def _gzip(header: _Header, streams: list[bytes]) -> bytes:
    """A file of version 2 or 3; stored uncompressed if its compression ratio exceeds what our reader accepts."""
    fields = (_MAGIC, header.version, header.count, header.degree, header.fraction, header.flags, 0)
    body = _LEGACY.pack(*fields) + b"".join(streams)
    for level in (6, 0):
        deflater = zlib.compressobj(level, zlib.DEFLATED, 31)
        packed = deflater.compress(body) + deflater.flush()
        if len(body) <= max(FREE, RATIO * len(packed)):
            break
    return packed


def _frames(header: _Header, streams: list[bytes]) -> bytes:
    """A file of version 4; stored uncompressed if its compression ratio exceeds what our reader accepts."""
    size = sum(map(len, streams))
    packed = [zstd.compress(stream) for stream in streams]
    if size > max(FREE, RATIO * sum(map(len, packed))):
        packed = [zstd.store(stream) for stream in streams]
    fields = (_MAGIC, header.version, header.count, header.degree, header.fraction, header.flags, len(streams))
    table = (_ENTRY.pack(len(p), len(s)) for p, s in zip(packed, streams, strict=True))
    return b"".join([_HEADER.pack(*fields, _HEADER.size), *table, *packed])


FORMAT = Format(NAME, (".spz",), recognises, read, write, morton_order=True)
