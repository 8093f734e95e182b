"""Files and folders by URL (`s3://`, `gs://`, `sftp://`, `file://`, what fsspec knows): `fetched` gives a local copy.

A copy is kept in the user's cache under what the store says of the content (ETag, size, time), with the language field
and the motion beside it. Neither passwords in a URL nor its query, which may be a signature, are told or kept.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import re
import secrets
import shutil
import time
from collections.abc import Iterator
from pathlib import Path, PurePosixPath
from typing import Any
from urllib.parse import unquote

from ..errors import BackendError, FileError, UserError
from ..user_cache import user_cache
from .motion_file import SUFFIX as MOTION

FIELD = ".field.safetensors"
BESIDE = (MOTION, FIELD)  # ends of the names of what belongs to a scene
VARIABLE = "SCENEWRIGHT_FETCHED"  # bytes that fetched copies may take, such as 20GB
KEPT = 20 * 10**9
_USED = 3600.0  # seconds since its last use in which a copy is not removed
_MOST_FILES = 10_000  # of a folder
_TRIES = 3
_BLOCK = 1 << 22
_URL = re.compile(r"([a-z][a-z0-9+.-]{1,15}(?:::[a-z][a-z0-9+.-]{1,15})*)://\S")
_USER = re.compile(r"(?<=://)[^/\s]*@")
_QUERY = re.compile(r"\?\S*")
_IN_TEXT = re.compile(r"[a-z][a-z0-9+.-]{1,15}://[^\s'\"<>)]+")
# What file systems call that which changes with the content.
_VERSIONS = (
    "ETag", "etag", "md5Hash", "md5", "checksum", "content_hash", "crc32c", "VersionId", "generation", "mtime",
    "LastModified", "last_modified", "modified", "updated", "created", "ino",
)  # fmt: skip
Files = dict[str, dict[str, Any]]


def is_url(word: object) -> bool:
    """Whether a word starts as a URL does; sentences that hold one do not."""
    return isinstance(word, str) and _URL.match(word) is not None


def cleaned(text: str) -> str:
    """Text whose URLs have lost user, password and query."""
    return _IN_TEXT.sub(lambda found: _QUERY.sub("?...", _USER.sub("", found[0])), text)


def opened(url: str) -> tuple[Any, str]:
    """The file system of a URL and the path there.

    Raises:
        BackendError: a package is missing; the message names it.
        UserError: no file system has such a name, or the URL is malformed.
        FileError: the store cannot be reached.
    """
    try:
        from fsspec.core import url_to_fs
    except ImportError as error:
        raise BackendError("URLs need the package fsspec; run: pip install 'scenewright[remote]'") from error
    try:
        fs, path = url_to_fs(url)
    except ImportError as error:
        raise BackendError(
            f"{cleaned(url)}: {error}; run: pip install 'scenewright[remote]' and the package named"
        ) from error
    except ValueError as error:
        raise UserError(f"{cleaned(url)} is no URL of a file: {told(error, url)}") from error
    except Exception as error:  # a store raises whatever its client raises
        raise FileError(f"cannot reach {cleaned(url)}: {told(error, url)}") from error
    return fs, str(path)


@contextlib.contextmanager
def reaching(url: str, verb: str = "read") -> Iterator[None]:
    """What a store raises, as a `FileError` that says what could not be done, without secrets."""
    try:
        yield
    except (FileError, UserError, BackendError):
        raise
    except Exception as error:  # a store raises whatever its client raises
        raise FileError(f"cannot {verb} {cleaned(url)}: {told(error, url)}") from error


def told(error: BaseException, url: str) -> str:
    """What an error says, in one line, without the secrets of a URL."""
    text = " ".join((str(error) or type(error).__name__).split())[:500]
    user = _USER.search(url)
    for secret in [] if user is None else [p for p in user[0][:-1].split(":") if p]:
        text = text.replace(secret, "...").replace(unquote(secret), "...")
    return cleaned(text)


def version(url: str, field: bool = True) -> str | None:
    """Tells the content of the file or folder at a URL from any other content; None if nothing is there.

    Args:
        field: whether a language field beside it counts.

    Raises:
        FileError, BackendError, UserError: the store cannot be asked.
    """
    fs, path = opened(url)
    with reaching(url):
        files = _files(fs, path, url)
        if not files:
            return None
        counted = {name: info for name, info in files.items() if field or name != path + FIELD}
        return _digest(fs, path, counted)


def fetched(url: str) -> Path:
    """A local copy of the file or folder at a URL, with what is beside it; not to be written to.

    Raises:
        FileError, BackendError, UserError: nothing is there, the store cannot be read, or it changes all the time.
    """
    fs, path = opened(url)
    if "file" in _protocols(fs):
        return Path(path)
    for _ in range(_TRIES):
        with reaching(url):
            files = _files(fs, path, url)
            mark = _digest(fs, path, files) if files else ""
        if not files:
            raise FileError(f"no such file or folder: {cleaned(url)}")
        place = user_cache("fetched", hashlib.sha256(f"{cleaned(url)} {mark}".encode()).hexdigest()[:32])
        copy = place / PurePosixPath(path).name
        if copy.exists():
            os.utime(place)
            return copy
        part = place.with_name(f"{place.name}.{secrets.token_hex(6)}.part")
        try:
            with reaching(url):
                _get(fs, path, files, part)
                same = _digest(fs, path, _files(fs, path, url)) == mark
            if same:
                with contextlib.suppress(OSError):  # another process was first
                    os.replace(part, place)
                _prune(place.parent, place)
                return copy
        finally:
            shutil.rmtree(part, ignore_errors=True)
    raise FileError(f"{cleaned(url)} changes while it is read; try again when it is complete")


def copied(url: str, folder: Path) -> Path:
    """As `fetched`, but a copy in a folder, which may be written to."""
    source = fetched(url)
    folder.mkdir(parents=True, exist_ok=True)
    target = folder / source.name
    if source.is_dir():
        shutil.copytree(source, target)
    for beside in (source, *(source.with_name(source.name + end) for end in BESIDE)):
        if beside.is_file():
            shutil.copy2(beside, folder / beside.name)
    return target


def sent(folder: Path, url: str) -> dict[str, int]:
    """Write the files of a folder below a URL; the bytes of each, by its path in the folder.

    Raises:
        FileError, BackendError, UserError: the store cannot be written.
    """
    fs, root = opened(url)
    files = {p.relative_to(folder).as_posix(): p for p in sorted(folder.rglob("*")) if p.is_file()}
    with reaching(url, "write into"):
        for name, path in files.items():
            target = f"{root.rstrip('/')}/{name}"
            with contextlib.suppress(NotImplementedError, FileExistsError):  # object stores have no folders
                fs.makedirs(target.rpartition("/")[0], exist_ok=True)
            fs.put_file(str(path), target)
    return {name: path.stat().st_size for name, path in files.items()}


def local(path: str | Path) -> Path:
    """A path, or the local copy of a URL."""
    return fetched(path) if isinstance(path, str) and is_url(path) else Path(path)


def _protocols(fs: Any) -> tuple[str, ...]:
    return (fs.protocol,) if isinstance(fs.protocol, str) else tuple(fs.protocol)


def _files(fs: Any, path: str, url: str) -> Files:
    """What the store says of each file of a scene, by its path there; empty if there is none."""
    fs.invalidate_cache()
    found: Files = {}
    said = _info(fs, path)
    if said is not None and said["type"] == "directory":
        found = {str(name): info for name, info in fs.find(path, detail=True).items()}
        if len(found) > _MOST_FILES:
            raise UserError(f"{cleaned(url)} holds {len(found):,} files; name the folder of one scene")
    elif said is not None:
        found[path] = said
    if found:
        found |= {path + end: info for end in BESIDE if (info := _info(fs, path + end)) is not None}
    return found


def _info(fs: Any, path: str) -> dict[str, Any] | None:
    """What a store says of a file or folder; None if there is none. (`fs.exists` also says so where asking failed.)"""
    try:
        return dict(fs.info(path))
    except FileNotFoundError:
        return None


def _digest(fs: Any, path: str, files: Files) -> str:
    found = hashlib.sha256()
    for name in sorted(files):
        info = files[name]
        versions = [f"{key}={info[key]}" for key in _VERSIONS if info.get(key) is not None]
        content = "" if versions else _content(fs, name)
        found.update(f"{name[len(path) :]} {info.get('size')} {versions} {content}\n".encode())
    return found.hexdigest()


def _content(fs: Any, path: str) -> str:
    """Hash of a file of which the store tells no version."""
    found = hashlib.sha256()
    with fs.open(path, "rb") as file:
        while block := file.read(_BLOCK):
            found.update(block)
    return found.hexdigest()


def _get(fs: Any, path: str, files: Files, folder: Path) -> None:
    """Copy files of a store into a new folder, which holds the scene under its name."""
    name = PurePosixPath(path).name
    if not name:
        raise UserError(f"{path} is a whole store; name the folder of one scene in it")
    for file in files:
        target = folder / (name + file[len(path) :])
        if not target.resolve().is_relative_to(folder.resolve()):
            raise FileError(f"the store names a file {file}, which would lie outside of its folder")
        target.parent.mkdir(parents=True, exist_ok=True)
        fs.get_file(file, str(target))


def _prune(cache: Path, keep: Path) -> None:
    """Remove the copies that were used longest ago until the others take no more than they may."""
    from ..tiles.budget import parse_memory

    most = parse_memory(os.environ[VARIABLE]) if os.environ.get(VARIABLE) else KEPT
    with contextlib.suppress(OSError):  # another process removes too
        ages = sorted(((p.stat().st_mtime, p) for p in cache.iterdir() if p.is_dir()), reverse=True)
        total = 0
        for when, place in ages:
            total += sum(file.stat().st_size for file in place.rglob("*") if file.is_file())
            if total > most and place != keep and time.time() - when > _USED:
                shutil.rmtree(place, ignore_errors=True)
