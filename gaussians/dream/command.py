"""Objects from any program that turns words or a picture into Gaussians: `command:"PROGRAM {prompt} {output}"`.

The program runs without a shell, so that no word of a prompt is ever read as a command.
"""

from __future__ import annotations

import contextlib
import os
import shlex
import signal
import subprocess
import tempfile
from pathlib import Path

from ..cloud import GaussianCloud
from ..errors import BackendError, ScenewrightError, UserError

PREFIX = "command:"
PLACES = ("{prompt}", "{image}", "{output}")
OUTPUT = "object.ply"
LEAST, MOST = 8, 2_000_000  # Gaussians of an object: that can be seen, and in all
FAINT = 0.05  # opacity up to which a Gaussian is not seen
_TOLD = 300  # characters of what a program says when it fails


def arguments(spec: str, prompt: str, image: Path | None, output: Path) -> list[str]:
    """The program and its arguments, with words and paths filled in.

    Args:
        spec: "command:PROGRAM ARGUMENT ...", quoted as in a shell; `{output}` has to be in it, and `{image}` where a
            picture is given.

    Raises:
        UserError: the specification has no program, a quote that is not closed, or not the places that are needed.
    """
    try:
        parts = shlex.split(spec.removeprefix(PREFIX))
    except ValueError as error:
        raise UserError(f"cannot read {spec!r}: {error}; close its quotes") from error
    if not parts or not any("{output}" in part for part in parts):
        raise UserError(f'{spec!r} names no program with {{output}}; say command:"PROGRAM {{prompt}} {{output}}"')
    if image is not None and not any("{image}" in part for part in parts):
        raise UserError(f"{spec!r} takes no picture; put {{image}} where its path belongs, or leave out --image")
    if image is None and any("{image}" in part for part in parts):
        raise UserError(f"{spec!r} wants a picture; give --image FILE")
    filled = dict(zip(PLACES, (prompt, str(image or ""), str(output)), strict=True))

    def fill(part: str) -> str:
        for place in PLACES:  # from left to right, once: what a prompt says is not filled in again
            before, found, after = part.partition(place)
            if found:
                return fill(before) + filled[place] + fill(after)
        return part

    return [fill(part) for part in parts]


def _run(command: list[str], seconds: float) -> subprocess.CompletedProcess[bytes]:
    """As `subprocess.run`, but what the program starts ends with it."""
    with subprocess.Popen(
        command, start_new_session=True, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as process:
        try:
            out, err = process.communicate(timeout=seconds)
        except BaseException:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            raise
    return subprocess.CompletedProcess(command, process.returncode, out, err)


def run(spec: str, prompt: str, image: Path | None, seconds: float) -> tuple[GaussianCloud, tuple[str, ...]]:
    """The Gaussians that a program writes, in the program's own axes, and what was repaired in them, a sentence each.

    Raises:
        UserError: see `arguments`.
        BackendError: the program is not there, fails, takes longer than `seconds`, or writes no Gaussians that can be
            read.
    """
    from ..files import load_with_report

    with tempfile.TemporaryDirectory(prefix="scenewright-") as folder:
        output = Path(folder) / OUTPUT
        command = arguments(spec, prompt, None if image is None else image.absolute(), output)
        try:
            done = _run(command, seconds)
        except FileNotFoundError as error:
            raise BackendError(f"there is no program {command[0]!r}; give its path in {PREFIX}...") from error
        except subprocess.TimeoutExpired as error:
            raise BackendError(f"{command[0]} took longer than {seconds:.0f} s; give it more with --minutes") from error
        except OSError as error:
            raise BackendError(f"cannot run {command[0]}: {error.strerror or error}") from error
        if done.returncode:
            said = done.stderr.decode("utf-8", "replace").strip()[-_TOLD:] or "it says nothing"
            raise BackendError(f"{command[0]} ended with {done.returncode}: {said}")
        written = sorted(p for p in Path(folder).iterdir() if p.is_file())
        if not written:
            raise BackendError(f"{command[0]} wrote nothing to {{output}} ({OUTPUT})")
        try:
            scene, report = load_with_report(output if output in written else written[0])
        except ScenewrightError as error:
            raise BackendError(f"what {command[0]} wrote cannot be used: {error}") from error
    cloud = scene.cloud
    seen = int((cloud.opacities > FAINT).sum())
    if seen < LEAST:
        raise BackendError(
            f"{command[0]} wrote {len(cloud):,} Gaussians, of which {seen} can be seen (opacity above {FAINT:g}); an "
            f"object has {LEAST} or more"
        )
    if len(cloud) > MOST:
        raise BackendError(f"{command[0]} wrote {len(cloud):,} Gaussians; an object has {MOST:,} at most")
    return cloud, report.notes
