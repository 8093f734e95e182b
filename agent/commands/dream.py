"""`scenewright dream "a red armchair" -o chair.ply --model diffusers:FOLDER`: an object from words or a picture."""

from __future__ import annotations

import math
import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from ..options import Debug, Force, Json, Seed
from ..terminal.output import terminal, time_left

if TYPE_CHECKING:
    from ...gaussians.dream.dreaming import Dreamed, Settings, Status
    from ...gaussians.dream.start import Start

MODEL = "SCENEWRIGHT_DREAM"  # names the model if --model does not
LIBRARY = "library"
PICTURE_EVERY = 20.0  # seconds between two pictures on the way
PICTURE_SIDE = 256  # px


def command(
    prompt: Annotated[str, typer.Argument(metavar="TEXT", help="What the object is: 'a red armchair, wooden legs'.")],
    output: Annotated[Path, typer.Option("--output", "-o", metavar="FILE", help="File for the object (.ply).")],
    model: Annotated[
        str | None,
        typer.Option(
            "--model",
            metavar="SPEC",
            envvar=MODEL,
            help="'diffusers:FOLDER' (Stable Diffusion 1 or 2; with --image, Image Variations); 'command:PROGRAM "
            "{prompt} {image} {output}', any program that writes Gaussians; or 'library': the nearest thing of the "
            "built-in library, without a model.",
        ),
    ] = None,
    image: Annotated[
        Path | None, typer.Option("--image", metavar="FILE", help="A picture of the object, seen from the front.")
    ] = None,
    start: Annotated[
        str,
        typer.Option(
            "--from",
            metavar="FORM",
            help="What it starts from: 'auto' (the library's thing of that kind, otherwise a sphere), 'procedural', "
            "'sphere', or a mesh or Gaussians (FILE.glb, FILE.ply).",
        ),
    ] = "auto",
    minutes: Annotated[float | None, typer.Option("--minutes", help="Time (10 unless --steps).")] = None,
    steps: Annotated[
        int | None, typer.Option("--steps", help="Number of steps instead of a time: same bytes every run on the CPU.")
    ] = None,
    size: Annotated[int, typer.Option("--size", help="Side of the pictures that are drawn, px.")] = 128,
    guidance: Annotated[float, typer.Option("--guidance", help="Weight of the words.")] = 50.0,
    max_gaussians: Annotated[
        int, typer.Option("--max-gaussians", metavar="N", help="Greatest number of Gaussians.")
    ] = 20_000,
    height: Annotated[
        float | None,
        typer.Option("--height", metavar="METRES", help="Height of the object; that of its kind by default."),
    ] = None,
    pictures: Annotated[
        Path | None, typer.Option("--pictures", metavar="FOLDER", help="Write a picture of the object on the way here.")
    ] = None,
    up: Annotated[
        Literal["auto", "x", "y", "z", "-x", "-y", "-z"],
        typer.Option(
            "--up",
            help="Axis that points up in what a program writes (-y in the axes of cameras, as in COLMAP); auto: y, "
            "or x or z as the kind's size tells.",
        ),
    ] = "auto",
    device: Annotated[
        Literal["auto", "cpu", "cuda"],
        typer.Option("--device", help="Where to draw; auto: an NVIDIA GPU if there is one and gsplat is installed."),
    ] = "auto",
    seed: Seed = 0,
    force: Force = False,
    as_json: Json = False,
    debug: Debug = False,
) -> None:
    """Dream an object by score distillation: views are drawn at random, and a model says what is wrong with them.

    An interrupted dream goes on from its last checkpoint (OUTPUT.checkpoint) with the same command. No model comes with
    the program.
    """  # fmt: skip
    import numpy as np

    from ...gaussians.dream import denoisers
    from ...gaussians.dream.command import PREFIX
    from ...gaussians.dream.dreaming import Settings, dream
    from ...gaussians.dream.generating import from_command
    from ...gaussians.dream.prior import library_thing, standing, start_for
    from ...gaussians.errors import UserError
    from ...gaussians.files import save
    from ...gaussians.fit import checkpoint
    from ...gaussians.fit.engine import resolve_device

    if minutes is not None and steps is not None:
        raise UserError("give --minutes or --steps, not both")
    if not 0 <= guidance < math.inf:
        raise UserError(f"--guidance is a number from 0 on, got {guidance:g}")
    if model is not None and model.startswith((LIBRARY, PREFIX)) and (idle := _idle(model, image, start, pictures)):
        raise UserError(f"{idle} does nothing with {model}; it is for diffusers:FOLDER")
    if image is not None and not image.is_file():
        raise UserError(f"there is no picture {image}")
    if height is not None and not 0.005 <= height <= 100:
        raise UserError(f"--height is between 0.005 and 100 metres, got {height:g}")
    _check_targets(output, pictures, force)
    if minutes is not None and not 0 < minutes < 10_000:
        raise UserError(f"--minutes is above 0, got {minutes:g}")
    if model is None:
        raise UserError(_without_model(prompt))
    if model == LIBRARY:
        scene = library_thing(prompt, seed)
        if height is not None:
            scene = standing(scene.cloud, prompt, height)
        save(scene, output, force=force)
        terminal.result(f"{output}: {len(scene.cloud):,} Gaussians from the library; nothing was dreamt",
                        {"output": str(output), "gaussians": len(scene.cloud), "model": LIBRARY})  # fmt: skip
        return
    seconds = None if steps is not None else 60 * (10.0 if minutes is None else minutes)
    if model.startswith(PREFIX):
        if seconds is None:
            raise UserError("--steps are for score distillation; a program gets --minutes")
        scene, axis, repaired = from_command(model, prompt, image, seconds, up, height)
        save(scene, output, force=force)
        for note in repaired:
            terminal.say(f"note: in what the program wrote, {note}")
        terminal.result(f"{output}: {len(scene.cloud):,} Gaussians, their {axis} axis was up",
                        {"output": str(output), "gaussians": len(scene.cloud), "model": model, "up": axis,
                         "notes": list(repaired)})  # fmt: skip
        return
    settings = Settings(seconds, steps, size, max_gaussians, seed=seed, device=resolve_device(device))
    first, told = start_for(start, prompt, max_gaussians, np.random.default_rng(seed), seed)
    knows = denoisers.load(model, prompt, image, guidance)
    kept = output.with_name(output.name + ".checkpoint")
    terminal.say(f"going on from {kept}" if kept.exists() else f"starting from {told}")
    try:
        done = dream(knows, first, settings, checkpoint_path=kept, on_status=_Shown(pictures))
    except KeyboardInterrupt:
        terminal.say(f"the same command goes on from {kept}" if kept.exists() else "no checkpoint was kept yet")
        raise
    scene = standing(done.cloud, prompt, height)
    save(scene, output, force=force)
    checkpoint.delete(kept)
    terminal.result(_summary(done, output), _data(done, output, model, settings, first, told))


def _idle(model: str, image: Path | None, start: str, pictures: Path | None) -> str:
    """The first given option that has no effect where nothing is dreamt; "" if there is none."""
    given = {
        "--from": start != "auto",
        "--pictures": pictures is not None,
        "--image": model == LIBRARY and image is not None,
    }
    return next((name for name, said in given.items() if said), "")


def _check_targets(output: Path, pictures: Path | None, force: bool) -> None:
    """Check before the dream that the files can be written."""
    from ...gaussians.files import writer
    from ..output_files import make_folder, refuse_existing, require_folder

    writer(output)
    require_folder(output)
    refuse_existing([output], force)
    if pictures is not None:
        make_folder(pictures)


def _without_model(prompt: str) -> str:
    """What to do without a model."""
    from ...gaussians.dream.prior import kind_of

    kind = kind_of(prompt)
    near = f"; without one, --model {LIBRARY} writes the library's {kind.asset}" if kind and kind.asset else ""
    return (
        "dreaming needs a text-to-image model: pip install 'scenewright[diffusion]', download a Stable Diffusion 1 or "
        f"2 pipeline into a folder, and name it with --model diffusers:FOLDER or {MODEL}{near}"
    )


class _Shown:
    """Reports progress, and writes pictures on the way."""

    def __init__(self, folder: Path | None) -> None:
        self._folder, self._last = folder, time.monotonic()

    def __call__(self, status: Status) -> None:
        terminal.progress(
            f"step {status.steps}, residual {status.residual:.3f}, {status.gaussians:,} Gaussians, "
            f"{time_left(status.seconds_left)}",
            status.share,
        )
        now = time.monotonic()
        if self._folder is not None and (now - self._last >= PICTURE_EVERY or status.share >= 1):
            self._last = now
            self._write(self._folder / f"step_{status.steps:06d}.png", status)

    @staticmethod
    def _write(path: Path, status: Status) -> None:
        import numpy as np

        from ...gaussians.dream.views import view
        from ...gaussians.render import render
        from ..pictures.image_files import save_png

        shots = [view(azimuth, 20.0, PICTURE_SIDE) for azimuth in (0.0, 90.0, 180.0, -90.0)]
        cloud = status.cloud()
        drawn = [render(cloud, s.camera, s.background).to_uint8() for s in shots]
        save_png(np.concatenate(drawn, axis=1), path)


def _summary(done: Dreamed, output: Path) -> str:
    return f"{output}: {len(done.cloud):,} Gaussians, {done.steps} steps in {done.seconds:.0f} s"


def _data(
    done: Dreamed, output: Path, model: str, settings: Settings, first: Start, told: str
) -> dict[str, object]:  # fmt: skip
    return {
        "output": str(output), "gaussians": len(done.cloud), "steps": done.steps, "seconds": round(done.seconds, 2),
        "residual": done.residual, "model": model, "from": told, "started_with": len(first.cloud),
        "seed": settings.seed,
    }  # fmt: skip
