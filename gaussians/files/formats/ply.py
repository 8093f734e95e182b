"""Reads the PLY container (Turk 1994): header, elements and rows of scalar properties, in three encodings.

List properties are refused, because no Gaussian format uses them.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO, Literal

import numpy as np
from numpy.typing import NDArray

from ...errors import FileError

Encoding = Literal["ascii", "binary_little_endian", "binary_big_endian"]

HEADER_LIMIT = 4 << 20  # bytes; far more than cameras in comments need
BLOCK_ROWS = 8192  # rows read at a time: about 2 MB at degree 3, which stays in cache
_TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2",
    "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4",
    "double": "f8", "float64": "f8",
}  # fmt: skip


@dataclass(frozen=True)
class Element:
    """One table of the file: `count` rows of named scalar properties."""

    name: str
    count: int
    properties: tuple[tuple[str, str], ...]  # name and numpy type without byte order

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(name for name, _ in self.properties)

    def dtype(self, encoding: Encoding) -> np.dtype[Any]:
        """Structured row type; ASCII rows are parsed into float64."""
        if encoding == "ascii":
            return np.dtype([(name, "f8") for name in self.names])
        order = "<" if encoding == "binary_little_endian" else ">"
        return np.dtype([(name, order + kind) for name, kind in self.properties])


@dataclass(frozen=True)
class Header:
    """A parsed PLY header; `size` is its length in bytes."""

    encoding: Encoding
    elements: tuple[Element, ...]
    comments: tuple[str, ...]
    size: int

    def element(self, name: str) -> Element | None:
        """The element of this name, if the file has it."""
        return next((e for e in self.elements if e.name == name), None)


def read_header(file: BinaryIO, path: Path) -> Header:
    """Parse the header and leave `file` at the first byte of the body.

    Raises:
        FileError: it is not a PLY header, has no end, or declares something that cannot be read.
    """
    lines = _header_lines(file, path)
    encoding: Encoding | None = None
    elements: list[tuple[str, int, list[tuple[str, str]]]] = []
    comments: list[str] = []
    for line in lines[1:-1]:
        match line.split():
            case [] | ["obj_info", *_]:
                pass
            case ["comment", *_]:
                comments.append(line.strip()[len("comment") :].strip())
            case ["format", ("ascii" | "binary_little_endian" | "binary_big_endian") as found, "1.0"]:
                encoding = found
            case ["element", name, count] if count.isascii() and count.isdigit() and len(count) < 19:
                elements.append((name, int(count), []))
            case ["property", kind, name] if kind in _TYPES and elements:
                if name in dict(elements[-1][2]):
                    raise FileError(f"{path}: the header names property {name!r} twice")
                elements[-1][2].append((name, _TYPES[kind]))
            case ["property", "list", *_]:
                raise FileError(f"{path}: list properties ({line.strip()!r}) belong to meshes; Gaussians have none")
            case _:
                raise FileError(f"{path}: cannot read header line {line.strip()[:80]!r}")
    if encoding is None:
        raise FileError(f"{path}: the header has no format line (ascii or binary_…_endian, version 1.0)")
    tables = tuple(Element(name, count, tuple(properties)) for name, count, properties in elements)
    return Header(encoding, tables, tuple(comments), file.tell())


def _header_lines(file: BinaryIO, path: Path) -> list[str]:
    """The lines from "ply" to "end_header", without line breaks."""
    if file.readline(8).rstrip(b"\r\n") != b"ply":
        raise FileError(f"{path}: not a PLY file (it does not start with the line 'ply')")
    lines = ["ply"]
    while file.tell() < HEADER_LIMIT:
        raw = file.readline(HEADER_LIMIT)
        if not raw:
            break
        lines.append(raw.decode("utf-8", errors="replace").rstrip("\r\n"))
        if lines[-1].rstrip() == "end_header":
            return lines
    raise FileError(f"{path}: the PLY header has no end_header line; the file is cut off or not a PLY file")


def read_rows(file: BinaryIO, path: Path, header: Header, name: str) -> Iterator[tuple[int, NDArray[Any]]]:
    """Blocks of rows of one element as `(first row, structured array)`, in order.

    No more than one block is allocated. Callers may allocate `count` rows after the first call, because it checks
    the counts in the header against the size of the file.

    Raises:
        FileError: the file holds fewer rows than its header declares, or an ASCII row cannot be parsed.
    """
    return read_blocks(file, path, header, name, BLOCK_ROWS)


def read_blocks(
    file: BinaryIO, path: Path, header: Header, name: str, rows: int, every: int = 1
) -> Iterator[tuple[int, NDArray[Any]]]:
    """As `read_rows`, in blocks of `rows` rows.

    Args:
        every: of these blocks only the first, and each so many-th after it.

    Raises:
        FileError: as `read_rows`.
    """
    _check_size(file, path, header)
    if header.encoding == "ascii":
        found = _ascii_rows(file, path, header, name, rows)
        return (block for k, block in enumerate(found) if k % every == 0)
    return _binary_rows(file, path, header, name, rows, every)


def _check_size(file: BinaryIO, path: Path, header: Header) -> None:
    """Refuse a header that declares more rows than the file can hold."""
    end = file.seek(0, 2)
    left = end - header.size
    for element in header.elements:
        # The shortest ASCII row is a digit and a separator for each property.
        row = len(element.properties) * 2 if header.encoding == "ascii" else element.dtype(header.encoding).itemsize
        needed = element.count * row - (1 if header.encoding == "ascii" else 0)
        if needed > left:
            fit = left // row if row else 0
            raise FileError(
                f"{path}: the header declares {element.count:,} {element.name} rows, the file ends after at most "
                f"{fit:,}; it is cut off, download it again"
            )
        left -= max(needed, 0)


def left_over(file: BinaryIO, header: Header, name: str) -> tuple[str, ...]:
    """A note if the file holds more rows than its header declares: those after its last element, if they are of
    element `name`; nothing if it ends there. Bytes too few for a row are passed over, as some writers pad their files.
    """
    element = header.element(name)
    if element is None or header.elements[-1] is not element:
        return ()
    if header.encoding == "ascii":
        file.seek(header.size)
        more = sum(1 for line in file if line.strip()) - sum(e.count for e in header.elements)
    else:
        row = element.dtype(header.encoding).itemsize
        known = sum(e.count * e.dtype(header.encoding).itemsize for e in header.elements)
        more = (file.seek(0, 2) - header.size - known) // row
    if more < 1:
        return ()
    return (
        f"the header declares {element.count:,} {name} rows, the file holds about {more:,} more, which were left out",
    )


def _binary_rows(
    file: BinaryIO, path: Path, header: Header, name: str, block: int, every: int
) -> Iterator[tuple[int, NDArray[Any]]]:
    file.seek(header.size)
    for element in header.elements:
        dtype = element.dtype(header.encoding)
        if element.name != name:
            file.seek(element.count * dtype.itemsize, 1)
            continue
        body = file.tell()
        for start in range(0, element.count, block * every):
            rows = min(block, element.count - start)
            file.seek(body + start * dtype.itemsize)
            data = file.read(rows * dtype.itemsize)
            if len(data) < rows * dtype.itemsize:
                raise FileError(f"{path}: the file was truncated while it was read")
            yield start, np.frombuffer(data, dtype)
        return


def _ascii_rows(
    file: BinaryIO, path: Path, header: Header, name: str, block: int
) -> Iterator[tuple[int, NDArray[Any]]]:
    file.seek(header.size)
    for element in header.elements:
        dtype = element.dtype(header.encoding)
        for start in range(0, element.count, block):
            wanted = min(block, element.count - start)
            lines = list(itertools.islice(file, wanted))
            if element.name == name:
                yield start, _parse_ascii(lines, wanted, dtype, f"{path}: {name} rows {start}–{start + wanted - 1}")
        if element.name == name:
            return


def _parse_ascii(lines: list[bytes], wanted: int, dtype: np.dtype[Any], where: str) -> NDArray[Any]:
    """Parse lines of numbers into structured rows."""
    width = len(dtype.names or ())
    tokens = [line.split() for line in lines]
    if len(tokens) < wanted or any(len(row) != width for row in tokens):
        raise FileError(f"{where}: expected {wanted} lines of {width} numbers each")
    try:
        return np.array(tokens, dtype="S").astype(np.float64).view(dtype).reshape(wanted)
    except ValueError as error:
        raise FileError(f"{where}: not a number ({error})") from error
