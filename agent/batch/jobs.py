"""Jobs of a batch: command lines with an id, told apart by what they say and by the content of the files they read."""

from __future__ import annotations

import hashlib
import json
import re
import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from ...gaussians.errors import FileError, UserError
from ...gaussians.files.remote import cleaned, version
from ..urls import urls
from .resources import NOTHING, Resources

TAKEN = frozenset({"receipts", "receipts.jsonl"})  # in the batch's folder
OUT = "{out}"  # in an argument: the folder of the job
VERBS = frozenset(
    {
        "ask", "check", "compose", "convert", "describe", "dream", "edit", "embed", "export", "find-view", "fit",
        "info", "mesh", "name-all", "plan", "render", "select", "slim",
    }
)  # fmt: skip
NAMING = frozenset({"embed", "name-all"})  # verbs that write the field themselves
_ID = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,99}")
_BLOCK = 1 << 22
MOST_FILES = 10_000  # of a folder that a job reads


class Job(BaseModel):
    """One command line.

    Attributes:
        id: name of the job, of its folder and in its receipt; letters, digits, dot, dash and underscore.
        run: the verb and its arguments, as on the command line; `{out}` stands for the job's folder.
        resources: what a worker has to have for it.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    id: Annotated[str, Field(max_length=100)]
    run: tuple[str, ...]
    resources: Resources = NOTHING

    def key(self) -> str:
        """Tells what the job does: its words, and the content of the files, folders and URLs that it names.

        Raises:
            FileError, BackendError, UserError: a URL cannot be asked.
        """
        found = hashlib.blake2b(json.dumps([cleaned(word) for word in self.run]).encode(), digest_size=16)
        for url in urls(self.run):
            found.update((version(url, self.run[0] not in NAMING) or "").encode())
        for word in self.run[1:]:
            path = Path(word.partition("=")[2] if word.startswith("--") and "=" in word else word)
            if OUT not in word and len(word) < 4096 and _exists(path):
                found.update(_content(path, self.run[0] not in NAMING))
        return found.hexdigest()


def read_jobs(path: Path) -> list[Job]:
    """The jobs of a file: an object `{"id", "run"}` on each line, `run` a list of words, or a line as for a shell.

    Raises:
        FileError: it cannot be read.
        UserError: a line is no job, names a verb that is not for batches, or has the id of another; the message names
            the line.
    """
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise FileError(f"cannot read {path}: {getattr(error, 'strerror', None) or error}") from error
    found, seen = list[Job](), dict[str, int]()
    for number, line in enumerate(lines, start=1):
        if not line.strip():
            continue
        where = f"{path}, line {number}"
        job = _job(line, where)
        if not _ID.fullmatch(job.id):
            raise UserError(f"{where}: the id {job.id!r} is no name of a folder; use letters, digits, . _ and -")
        if job.id in seen:
            raise UserError(f"{where}: the id {job.id!r} is that of line {seen[job.id]}; give each job its own")
        if job.id.lower() in TAKEN:
            raise UserError(f"{where}: the id {job.id!r} is the name of what the batch itself writes; use another")
        if not job.run or job.run[0] not in VERBS:
            said = job.run[0] if job.run else ""
            raise UserError(f"{where}: {said!r} is no verb for batches; use {', '.join(sorted(VERBS))}")
        seen[job.id] = number
        found.append(job)
    if not found:
        raise UserError(f'{path} holds no jobs; write a line such as {{"id": "a", "run": ["info", "room.ply"]}}')
    return found


def needing(jobs: Sequence[Job], needs: Mapping[str, Resources]) -> list[Job]:
    """The jobs with what their verbs need; what a job itself asks for wins.

    Raises:
        UserError: a verb is not for batches.
    """
    if strange := sorted(set(needs) - VERBS):
        raise UserError(f"{strange[0]!r} is no verb for batches; use {', '.join(sorted(VERBS))}")
    return [
        job.model_copy(update={"resources": needs[job.run[0]].model_copy(update=job.resources.asked())})
        if job.run[0] in needs
        else job
        for job in jobs
    ]


def _job(line: str, where: str) -> Job:
    try:
        data = json.loads(line)
        if isinstance(data, dict) and isinstance(data.get("run"), str):
            data["run"] = shlex.split(data["run"])
        return Job.model_validate(data)
    except ValidationError as error:
        first = error.errors()[0]
        raise UserError(f"{where}: {'.'.join(map(str, first['loc'])) or 'job'}: {first['msg']}") from error
    except (ValueError, RecursionError) as error:
        raise UserError(f"{where} is no job: {error}") from error


def arguments(run: Sequence[str], folder: str) -> list[str]:
    """The command line of a job whose results go into a folder; results as JSON."""
    filled = [word.replace(OUT, folder) for word in run]
    return filled if "--json" in filled else [*filled, "--json"]


def _exists(path: Path) -> bool:
    try:
        return path.exists()
    except (OSError, ValueError):  # a sentence is no path
        return False


def _content(path: Path, field: bool) -> bytes:
    """Digest of a file, with the motion and, if it counts, the field beside it; of a folder: names, sizes, times."""
    from ...gaussians.files.motion_file import motion_path
    from ...gaussians.language.field.store import field_path

    found = hashlib.blake2b(digest_size=16)
    if path.is_dir():
        files = sorted(p for p in path.rglob("*") if p.is_file())[:MOST_FILES]
        for file in files:
            told = file.stat()
            found.update(f"{file.relative_to(path)} {told.st_size} {told.st_mtime_ns}\n".encode())
        return found.digest()
    for file in (path, motion_path(path), *((field_path(path),) if field else ())):
        if file.is_file():
            with open(file, "rb") as opened:
                while block := opened.read(_BLOCK):
                    found.update(block)
    return found.digest()
