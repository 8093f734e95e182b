"""One object from words, by whichever back end; kept by what it was made from, as making takes minutes."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..errors import BackendError
from ..scene import Scene
from ..user_cache import user_cache
from . import command, denoisers
from .dreaming import Settings, dream
from .prior import kind_of, standing, start_for
from .upright import Up, upright

SECONDS = 600.0  # of a thing whose time nobody says


@dataclass(frozen=True)
class Generator:
    """Makes things by a specification.

    Attributes:
        spec: "command:PROGRAM ..." or "diffusers:FOLDER".
        seconds: that one thing may take.
        seed: of all random numbers of score distillation.
        folder: where things are kept.
    """

    spec: str
    seconds: float = SECONDS
    seed: int = 0
    folder: Path | None = None

    def __post_init__(self) -> None:
        if not self.spec.startswith((command.PREFIX, "diffusers:")):
            raise BackendError(f'unknown model {self.spec!r}; use diffusers:FOLDER or command:"PROGRAM {{output}}"')

    def path(self, prompt: str) -> Path:
        """The file of a thing: made if it is not there, otherwise what was made before.

        Raises:
            BackendError: the back end fails.
            FileError: it cannot be written.
        """
        from ..files import save

        root = self.folder if self.folder is not None else kept()
        key = hashlib.sha256(f"{Path.cwd()}\n{self.spec}\n{prompt}\n{self.seed}".encode()).hexdigest()[:24]
        path = root / f"{key}.ply"
        if not path.is_file():
            root.mkdir(parents=True, exist_ok=True)
            save(self.make(prompt), path, force=True)
        return path

    def make(self, prompt: str) -> Scene:
        """A thing, standing, in metres."""
        if self.spec.startswith(command.PREFIX):
            return from_command(self.spec, prompt, None, self.seconds)[0]
        rng = np.random.default_rng(self.seed)
        settings = Settings(seconds=self.seconds, seed=self.seed, device="auto")
        start, _ = start_for("auto", prompt, settings.max_gaussians, rng, self.seed)
        return standing(dream(denoisers.load(self.spec, prompt), start, settings).cloud, prompt)


def from_command(
    spec: str, prompt: str, image: Path | None, seconds: float, up: Up = "auto", height: float | None = None
) -> tuple[Scene, str, tuple[str, ...]]:
    """What a program makes, upright, standing, in metres; the axis that was up; and what was repaired in it.

    Raises:
        UserError, BackendError: as `command.run`.
    """
    made, repaired = command.run(spec, prompt, image, seconds)
    cloud, axis = upright(made, kind_of(prompt), up)
    return standing(cloud, prompt, height), axis, repaired


def kept() -> Path:
    """The folder in which things are kept."""
    return user_cache("dreams")
