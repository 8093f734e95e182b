"""Scenes fitted for measuring: each capture is fitted once with a fixed number of steps, and kept in the user's cache.

`SCENEWRIGHT_BENCH_SCENES` may name a folder with `NAME.ply` of scenes that are fitted already.
"""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from ....agent.terminal.output import terminal
from ....gaussians.files import load, save
from ....gaussians.fit import Settings, fit, load_photos
from ....gaussians.scene import Scene
from ....gaussians.user_cache import user_cache
from ..._data import folder

READY = "SCENEWRIGHT_BENCH_SCENES"
CAPTURES = ("diorama_table", "desk_laptop", "bench_box")  # whose scenes are not among the data
STEPS = 2000  # about two minutes on two processor cores
VERSION = 1  # part of the file's name: raise it when the same steps give another scene


def scene_of(capture: Path) -> Scene:
    """The fitted scene of a capture with the photographs' cameras."""
    ready = os.environ.get(READY)
    given = None if ready is None else Path(ready) / f"{capture.name}.ply"
    if given is not None and given.is_file():
        return load(given)
    root = user_cache("bench")
    kept = root / f"{capture.name}-{STEPS}-{VERSION}.ply"
    if not kept.is_file():
        terminal.say(f"note: fitting {capture.name} in {STEPS} steps, once; it is kept as {kept}")
        root.mkdir(parents=True, exist_ok=True)
        fitted = fit(load_photos(capture), Settings(steps=STEPS))
        with tempfile.TemporaryDirectory(dir=root) as place:
            save(fitted.scene, Path(place) / kept.name)
            (Path(place) / kept.name).replace(kept)
    return load(kept)


def main() -> None:
    """Fit every capture that benchmarks look at and that is not kept yet: six minutes on two idle cores."""
    captures = folder("captures")
    for name in CAPTURES:
        if captures is not None and (captures / name).is_dir():
            scene_of(captures / name)


if __name__ == "__main__":
    main()
