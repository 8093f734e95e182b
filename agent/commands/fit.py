"""`scenewright fit CAPTURE -o scene.ply`: photographs, with poses or without, to a trained scene."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from ..options import Debug, Force, Json, Seed
from ..terminal.output import terminal

if TYPE_CHECKING:
    from ...gaussians.fit import Fitted, Photos, Settings, Status

NAMED = 8  # photographs in a warning


def command(
    capture: Annotated[
        Path,
        typer.Argument(
            metavar="CAPTURE", help="A folder with transforms.json or COLMAP's sparse/0, or of photographs."
        ),
    ],
    output: Annotated[Path, typer.Option("--output", "-o", metavar="FILE", help="Where to write the scene (.ply).")],
    minutes: Annotated[float | None, typer.Option("--minutes", help="How long to train (5 unless --steps).")] = None,
    steps: Annotated[
        int | None, typer.Option("--steps", help="How many steps instead: the same bytes every time (on the CPU).")
    ] = None,
    most: Annotated[int, typer.Option("--max-gaussians", metavar="N", help="The budget of Gaussians.")] = 200_000,
    degree: Annotated[
        Literal["auto", "0", "1", "2", "3"],
        typer.Option("--sh-degree", help="Degree of the harmonics (how colour changes with the view), or by its gain."),
    ] = "auto",
    gain: Annotated[
        float,
        typer.Option("--gain", metavar="DB", help="What a band, or the last tenth of the Gaussians, must be worth."),
    ] = 0.05,
    coarse: Annotated[
        float, typer.Option("--coarse", metavar="SHARE", help="Share of the training at half the size, from 0 to 1.")
    ] = 0.0,
    scale: Annotated[
        float | None, typer.Option("--scale", help="Learn from photographs so many times their size; 1 is whole.")
    ] = None,
    growth: Annotated[
        Literal["budgeted", "classic"],
        typer.Option("--growth", help="How Gaussians come and go: to a number, or as first published."),
    ] = "budgeted",
    device: Annotated[
        Literal["auto", "cpu", "cuda"],
        typer.Option("--device", help="Where to train; auto: on an NVIDIA GPU if gsplat and one are there."),
    ] = "auto",
    report: Annotated[
        Path | None,
        typer.Option("--report", metavar="FOLDER", help="Write report.json and pictures beside held-out photographs."),
    ] = None,
    seed: Seed = 0,
    force: Force = False,
    as_json: Json = False,
    debug: Debug = False,
) -> None:
    """Train a scene on photographs, on the CPU or a GPU.

    Every eighth photograph is held out and measured with. Training goes on from its last checkpoint
    (OUTPUT.checkpoint) if it was ended before its time. Photographs without poses are given them first (extra sfm);
    they are kept in OUTPUT.poses, and estimated again only if the photographs change.
    """
    from ...gaussians.errors import FileError, UserError
    from ...gaussians.files import save
    from ...gaussians.files.captures.capture import unposed_photos
    from ...gaussians.fit import Settings, fit, load_photos
    from ...gaussians.fit.checkpoint import delete
    from ...gaussians.fit.engine import resolve_device

    if minutes is not None and steps is not None:
        raise UserError("give --minutes or --steps, not both")
    where = resolve_device(device)
    _check_targets(output, report, force)
    seconds = None if steps is not None else 60 * (5.0 if minutes is None else minutes)
    settings = Settings(
        seconds, steps, most, "auto" if degree == "auto" else int(degree), gain, growth, coarse, seed, where
    )
    poses = output.with_name(output.name + ".poses")
    if unposed_photos(capture) and not poses.exists():
        terminal.say(f"the photographs have no poses: estimating them first, on the CPU, to be kept in {poses}")
    photos = load_photos(capture, scale, terminal.progress, poses)
    terminal.say(_told(photos) + (", on the GPU" if where == "cuda" else ""))
    kept = output.with_name(output.name + ".checkpoint")
    if kept.exists():
        terminal.say(f"going on from {kept}")
    try:
        done = fit(photos, settings, checkpoint_path=kept, on_status=_tell)
    except KeyboardInterrupt:
        terminal.say(_left(kept))
        raise
    try:
        save(done.scene, output, force=force)
    except FileError as error:
        raise FileError(f"{error}; {_left(kept)}") from error
    delete(kept)
    data = _data(done, photos, settings, output)
    if report is not None:
        _write_report(done, photos, data, report, force)
    terminal.result("\n".join([_summary(done, output), *_chosen(done)]), data)


def _left(kept: Path) -> str:
    return f"the same command goes on from {kept}" if kept.exists() else "no checkpoint was kept yet"


def _check_targets(output: Path, report: Path | None, force: bool) -> None:
    """Say at once, not after the training, that a file would be overwritten, cannot be there or has no format."""
    from ...gaussians.errors import UserError
    from ...gaussians.files import writer
    from ..output_files import make_folder, refuse_existing, require_folder

    writer(output)
    require_folder(output)
    if output.is_dir() or output == report:
        raise UserError(f"{output} is a folder; give the name of a file in it")
    refuse_existing([output, *([report / "report.json"] if report is not None else [])], force)
    if report is not None:
        make_folder(report)


def _told(photos: Photos) -> str:
    from ...gaussians.fit.initialize import MIN_POINTS

    height, width = photos.shots[0].photo.shape[:2]
    many = len(photos.points.means)
    points = f"{many:,} surveyed points" if many else "no surveyed points, so poses cannot be checked"
    few = "; too few to begin from, so Gaussians begin anywhere" if many < MIN_POINTS else ""
    told = f"{len(photos.shots)} photographs at {width}x{height}, {len(photos.held_out)} held out, {points}{few}"
    if photos.poses_folder is not None:
        told += f", poses estimated: {photos.poses_folder} is a capture too"
    if photos.unplaced:
        named = ", ".join(photos.unplaced[:NAMED]) + (", ..." if len(photos.unplaced) > NAMED else "")
        every = len(photos.shots) + len(photos.held_out) + len(photos.unplaced)
        told += f"\nwarning: {len(photos.unplaced)} of {every} photographs left out, no place was found: {named}"
    return told if photos.warning is None else f"{told}\nwarning: {photos.warning}"


def _tell(status: Status) -> None:
    seen = "" if status.psnr != status.psnr else f", {status.psnr:.2f} dB held out"
    left = (
        f"{status.seconds_left / 60:.1f} min left" if status.seconds_left >= 60 else f"{status.seconds_left:.0f} s left"
    )
    terminal.progress(
        f"step {status.steps}, loss {status.loss:.4f}{seen}, {status.gaussians:,} Gaussians, {left}", status.share
    )


def _summary(done: Fitted, output: Path) -> str:
    how = f"{done.quality.psnr:.2f} dB, SSIM {done.quality.ssim:.3f} on {len(done.quality.each)} held-out photographs"
    return f"{output}: {len(done.scene.cloud):,} Gaussians, {how}, {done.steps} steps in {done.seconds:.0f} s"


def _chosen(done: Fitted) -> list[str]:
    """A line on the bands and one on the Gaussians that were tried."""
    told = []
    bands = [c for c in done.choices if c.what == "degree"]
    if bands:
        tried = ", ".join(f"without degree {c.before} {c.psnr[1] - c.psnr[0]:+.2f} dB" for c in bands)
        told.append(f"harmonics of degree {done.scene.cloud.degree}: {tried}")
    tenths = [c for c in done.choices if c.what == "gaussians"]
    if left := [c for c in tenths if c.taken]:
        lost = left[0].psnr[0] - left[-1].psnr[1]
        told.append(f"{left[0].before - left[-1].after:,} Gaussians left out, which cost {lost:.2f} dB at that moment")
    elif tenths:
        worth = tenths[0].psnr[0] - tenths[0].psnr[1]
        told.append(f"the last tenth of the Gaussians is worth {worth:.2f} dB; more may gain (--max-gaussians)")
    return told


def _data(done: Fitted, photos: Photos, settings: Settings, output: Path) -> dict[str, Any]:
    return {
        "path": str(output),
        "gaussians": len(done.scene.cloud),
        "sh_degree": done.scene.cloud.degree,
        "bytes": output.stat().st_size,
        "psnr": round(done.quality.psnr, 4),
        "ssim": round(done.quality.ssim, 4),
        "held_out": {name: [round(v, 4) for v in values] for name, values in done.quality.each.items()},
        "photographs": len(photos.shots),
        "unplaced": list(photos.unplaced),
        "steps": done.steps,
        "seconds": round(done.seconds, 2),
        "curve": [[round(s, 2), round(p, 3)] for s, p in done.curve],
        "choices": [asdict(c) for c in done.choices],
        "growth": settings.growth,
        "device": settings.device,
        "seed": settings.seed,
    }


def _write_report(done: Fitted, photos: Photos, data: dict[str, Any], folder: Path, force: bool) -> None:
    """The figures, and of each held-out photograph a picture: as taken, as rendered, their difference fourfold."""
    from ...gaussians.files import writing
    from ...gaussians.fit.quality import comparison
    from ..pictures.image_files import save_png

    with writing(folder / "report.json", force=force) as file:
        file.write((json.dumps(data, indent=2) + "\n").encode())
    for shot in photos.held_out:
        save_png(comparison(done.scene.cloud, shot), folder / f"{shot.camera.name}.png", force=force)
