"""`scenewright fit CAPTURE -o scene.ply`: train a scene on photographs, with or without camera poses."""

from __future__ import annotations

import json
import time
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from .. import startup
from ..options import Debug, Effort, Force, Json, Seed
from ..terminal.effort import dialled, reported, tell
from ..terminal.output import terminal, time_left

if TYPE_CHECKING:
    from ...gaussians.fit import Fitted, Photos, Settings, Status
    from ...gaussians.motion.fitting.fit import Still

MAX_NAMED = 8  # photographs named in a warning
SHORT = "as its share of the time was gone; with more --minutes, more may be found"
LEAST_LEFT = 0.3  # share of the time that is left to photographs after a search for what moves


def command(
    capture: Annotated[
        Path,
        typer.Argument(
            metavar="CAPTURE",
            help="A folder with transforms.json (or _train and _test), COLMAP's sparse/0, or photographs.",
        ),
    ],
    output: Annotated[Path, typer.Option("--output", "-o", metavar="FILE", help="File for the scene (.ply).")],
    minutes: Annotated[float | None, typer.Option("--minutes", help="Training time (5 unless --steps).")] = None,
    steps: Annotated[
        int | None, typer.Option("--steps", help="Number of steps instead of a time: same bytes every run on the CPU.")
    ] = None,
    max_gaussians: Annotated[
        int, typer.Option("--max-gaussians", metavar="N", help="Greatest number of Gaussians.")
    ] = 200_000,
    degree: Annotated[
        Literal["auto", "0", "1", "2", "3"],
        typer.Option("--sh-degree", help="Degree of the spherical harmonics; auto: chosen by the gain in PSNR."),
    ] = "auto",
    gain: Annotated[
        float,
        typer.Option(
            "--gain", metavar="DB", help="Gain for which a band, or the last tenth of the Gaussians, is kept."
        ),
    ] = 0.05,
    coarse: Annotated[
        float, typer.Option("--coarse", metavar="SHARE", help="Share of the training at half resolution, 0 to 1.")
    ] = 0.0,
    scale: Annotated[
        float | None, typer.Option("--scale", help="Factor on the size of the photographs; 1 is full resolution.")
    ] = None,
    growth: Annotated[
        Literal["budgeted", "classic"],
        typer.Option("--growth", help="Densification: up to a given number, or as first published."),
    ] = "budgeted",
    blocks: Annotated[
        str,
        typer.Option(
            "--blocks",
            metavar="N|auto",
            help="Fit a large capture by blocks of space, one after the other; auto: as --max-gaussians asks for.",
        ),
    ] = "auto",
    device: Annotated[
        Literal["auto", "cpu", "cuda"],
        typer.Option("--device", help="Where to train; auto: an NVIDIA GPU if there is one and gsplat is installed."),
    ] = "auto",
    strict: Annotated[
        bool, typer.Option("--strict", help="Refuse a capture that lists photographs which are not there.")
    ] = False,
    report: Annotated[
        Path | None,
        typer.Option("--report", metavar="FOLDER", help="Write report.json and comparisons with held-out photographs."),
    ] = None,
    effort: Effort = None,
    seed: Seed = 0,
    force: Force = False,
    as_json: Json = False,
    debug: Debug = False,
) -> None:
    """Train a scene on photographs, on the CPU or a GPU.

    Every eighth photograph is held out to measure the quality; of a folder with transforms_train.json those of its test
    (or val) file are. An interrupted training resumes from its last checkpoint
    (OUTPUT.checkpoint). If the photographs have no poses, these are estimated first (extra sfm) and kept in
    OUTPUT.poses; they are estimated again only if the photographs change. Frames with different times, from cameras
    that stand or one that moves, become a scene with motion if something moves in them, without checkpoints.
    """
    started = time.perf_counter()
    from ...gaussians.errors import FileError, UserError
    from ...gaussians.files import save
    from ...gaussians.files.captures.capture import unposed_photos
    from ...gaussians.fit import Settings, fit, load_photos
    from ...gaussians.fit import blocks as blocks_kept
    from ...gaussians.fit.blocks import fit_by_blocks
    from ...gaussians.fit.checkpoint import delete
    from ...gaussians.fit.engine import resolve_device

    startup.end()
    if minutes is not None and steps is not None:
        raise UserError("give --minutes or --steps, not both")
    dial = dialled(effort, started)
    if dial is not None and (minutes is not None or steps is not None):
        dial.overrule("--minutes" if steps is None else "--steps")
    where = resolve_device(device)
    _check_targets(output, report, force)
    seconds = None if steps is not None else 60 * (5.0 if minutes is None else minutes)
    settings = Settings(
        seconds, steps, max_gaussians, "auto" if degree == "auto" else int(degree), gain, growth, coarse, seed, where
    )
    parts = _blocks(blocks, settings, dial is not None)
    if parts > 1 and dial is not None:
        dial.overrule("--blocks")
    poses = output.with_name(output.name + ".poses")
    if unposed_photos(capture) and not poses.exists():
        terminal.say(f"the photographs have no poses: estimating them first, on the CPU, to be kept in {poses}")
    photos = load_photos(capture, scale, terminal.progress, poses, strict=strict)
    on_gpu = ", on the GPU" if where == "cuda" else ""
    kept = output.with_name(output.name + (".checkpoint" if parts == 1 else ".blocks"))
    if not photos.film or (parts == 1 and kept.exists()):  # a checkpoint: nothing that moves was found before it
        terminal.say(_describe(photos) + on_gpu)
    else:
        found = _fit_film(photos, settings, output, report, force)
        if found is None:
            return
        terminal.say(_still(found, on_gpu))
        photos, settings = found.photos, _shortened(settings, found.seconds)
    if kept.exists():
        terminal.say(f"going on from {kept}")
    try:
        if parts > 1:
            done = fit_by_blocks(photos, settings, parts, folder=kept, on_status=_show_status)
        else:
            free = None if dial is None or dial.overruled else dial
            done = fit(photos, settings, effort=free, checkpoint_path=kept, on_status=_show_status)
    except KeyboardInterrupt:
        terminal.say(_resume_hint(kept))
        raise
    try:
        save(done.scene, output, force=force)
    except FileError as error:
        raise FileError(f"{error}; {_resume_hint(kept)}") from error
    delete(kept) if parts == 1 else blocks_kept.delete(kept)
    data = _data(done, photos, settings, output)
    if report is not None:
        _write_report(done, photos, data, report, force)
    terminal.result("\n".join([_summary(done, output), *_chosen(done)]), data | reported(dial))
    tell(dial)


def _blocks(said: str, settings: Settings, dialled: bool) -> int:
    """The number of blocks; what is dialled is measured for one."""
    from ...gaussians.errors import UserError
    from ...gaussians.fit.blocks import blocks_for

    if said == "auto":
        return 1 if settings.growth == "classic" or dialled else blocks_for(settings.max_gaussians)
    if not said.isdecimal() or int(said) < 1:
        raise UserError(f"--blocks must be a number from 1 or auto, got {said!r}")
    if int(said) > 1 and settings.growth == "classic":
        raise UserError("--blocks keeps to a budget of Gaussians; it goes with --growth budgeted")
    return int(said)


def _fit_film(photos: Photos, settings: Settings, output: Path, report: Path | None, force: bool) -> Still | None:
    """Fit a scene with motion to the frames of a film, and write it; if nothing moves, what is to be fitted instead."""
    from ...gaussians.files import save
    from ...gaussians.motion.fitting.fit import Still, fit_what_moves, stands

    times = {shot.time for shot in (*photos.shots, *photos.held_out)}
    by = "" if stands(photos) else " by a moving camera"
    terminal.say(f"a film of {len(times)} times{by}: looking for what moves, on the CPU; " + _describe(photos))
    done = fit_what_moves(photos, settings, on_status=_show_status)
    if isinstance(done, Still):
        return done
    save(done.scene, output, force=force)
    motion = done.scene.motion
    tracks, residuals = (motion.tracks, motion.residuals) if motion is not None else ((), ())
    data = {
        "path": str(output), "gaussians": len(done.scene.cloud), "bytes": output.stat().st_size,
        "psnr": round(done.quality.psnr, 4), "ssim": round(done.quality.ssim, 4), "times": len(times),
        "tracks": [{"name": t.name, "kind": t.kind, "keys": len(t.times), "gaussians": len(t)} for t in tracks],
        "residuals": [{"rank": r.basis.shape[1], "gaussians": len(r.ids)} for r in residuals],
        "steps": done.steps, "seconds": round(done.seconds, 2), "seed": settings.seed,
    }  # fmt: skip
    if report is not None:
        from ...gaussians.files import writing

        with writing(report / "report.json", force=force) as file:
            file.write((json.dumps(data, indent=2) + "\n").encode())
    each = [f"{t.name} ({t.kind}, {len(t.times)} keys, {len(t):,} Gaussians)" for t in tracks]
    each += [f"{len(r.ids):,} Gaussians change their shape (rank {r.basis.shape[1]})" for r in residuals]
    how = f"{done.quality.psnr:.2f} dB, SSIM {done.quality.ssim:.3f} on {len(done.quality.each)} held-out frames"
    moves = f"moves: {', '.join(each)}" if each else "what was followed hardly moves: the scene stands still"
    if done.cut:
        moves += f"\nnote: the search for what moves ended early, {SHORT}"
    terminal.result(
        f"{output}: {len(done.scene.cloud):,} Gaussians, {how}, {done.steps} steps in {done.seconds:.0f} s, "
        f"without harmonics, as all films of what moves\n{moves}",
        data,
    )
    return None


def _still(found: Still, on_gpu: str) -> str:
    """Why a film is fitted as photographs are."""
    from ...gaussians.motion.fitting.fit import stands

    why = "nothing that moves was found"
    if found.cut:
        why = f"the search for what moves was given up after {found.seconds:.0f} s, {SHORT}"
    elif found.tried and stands(found.photos):
        why = "no path was found that explains what the frames show"
    elif found.tried:
        why = (
            "no path was found that explains what the frames show; of a moving camera, only what rests for a while at "
            "the start or at the end is followed"
        )
    return f"{why}: the frames are fitted as photographs of a scene that stands still{on_gpu}"


def _shortened(settings: Settings, seconds: float) -> Settings:
    """The settings of what is left after so many seconds."""
    from dataclasses import replace

    if settings.seconds is None:
        return settings
    return replace(settings, seconds=max(LEAST_LEFT * settings.seconds, settings.seconds - seconds))


def _resume_hint(kept: Path) -> str:
    return f"the same command goes on from {kept}" if kept.exists() else "no checkpoint was kept yet"


def _check_targets(output: Path, report: Path | None, force: bool) -> None:
    """Check before the training that the files can be written: no overwriting, existing folders, known formats."""
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


def _describe(photos: Photos) -> str:
    """Numbers and size of the photographs, survey points, estimated poses, and warnings."""
    from ...gaussians.fit.initialize import MIN_POINTS

    height, width = photos.shots[0].photo.shape[:2]
    many = len(photos.points.means)
    points = f"{many:,} surveyed points" if many else "no surveyed points, so poses cannot be checked"
    start = "where frames agree on a depth" if photos.film else "at random positions"
    few = f"; too few for initialization, so Gaussians start {start}" if many < MIN_POINTS else ""
    text = f"{len(photos.shots)} photographs at {width}x{height}, {len(photos.held_out)} held out, {points}{few}"
    if photos.poses_folder is not None:
        text += f", poses estimated: {photos.poses_folder} is a capture too"
    if photos.unplaced:
        named = ", ".join(photos.unplaced[:MAX_NAMED]) + (", ..." if len(photos.unplaced) > MAX_NAMED else "")
        every = len(photos.shots) + len(photos.held_out) + len(photos.unplaced)
        text += f"\nwarning: {len(photos.unplaced)} of {every} photographs left out, no pose was found: {named}"
    if photos.missing:
        named = ", ".join(name[:80] for name in photos.missing[:MAX_NAMED]) + (
            ", ..." if len(photos.missing) > MAX_NAMED else ""
        )
        text += f"\nwarning: {len(photos.missing)} photographs are listed, but not there, and are left out: {named}"
    text += "".join(f"\nnote: {note}" for note in photos.notes)
    return text if photos.warning is None else f"{text}\nwarning: {photos.warning}"


def _show_status(status: Status) -> None:
    seen = "" if status.psnr != status.psnr else f", {status.psnr:.2f} dB held out"
    left = time_left(status.seconds_left)
    terminal.progress(
        f"step {status.steps}, loss {status.loss:.4f}{seen}, {status.gaussians:,} Gaussians, {left}", status.share
    )


def _summary(done: Fitted, output: Path) -> str:
    how = f"{done.quality.psnr:.2f} dB, SSIM {done.quality.ssim:.3f} on {len(done.quality.each)} held-out photographs"
    return f"{output}: {len(done.scene.cloud):,} Gaussians, {how}, {done.steps} steps in {done.seconds:.0f} s"


def _chosen(done: Fitted) -> list[str]:
    """A line on the harmonic bands that were tried, and one on the Gaussians."""
    lines = []
    bands = [c for c in done.choices if c.what == "degree"]
    if bands:
        tried = ", ".join(f"without degree {c.before} {c.psnr[1] - c.psnr[0]:+.2f} dB" for c in bands)
        lines.append(f"harmonics of degree {done.scene.cloud.degree}: {tried}")
    tenths = [c for c in done.choices if c.what == "gaussians"]
    if left := [c for c in tenths if c.taken]:
        lost = left[0].psnr[0] - left[-1].psnr[1]
        lines.append(f"{left[0].before - left[-1].after:,} Gaussians left out, which cost {lost:.2f} dB at that moment")
    elif tenths:
        worth = tenths[0].psnr[0] - tenths[0].psnr[1]
        lines.append(f"the last tenth of the Gaussians is worth {worth:.2f} dB; more may gain (--max-gaussians)")
    return lines


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
        "missing": list(photos.missing),
        "steps": done.steps,
        "seconds": round(done.seconds, 2),
        "curve": [[round(s, 2), round(p, 3)] for s, p in done.curve],
        "choices": [asdict(c) for c in done.choices],
        "growth": settings.growth,
        "device": settings.device,
        "seed": settings.seed,
    }


def _write_report(done: Fitted, photos: Photos, data: dict[str, Any], folder: Path, force: bool) -> None:
    """Write report.json, and a picture for each held-out photograph: photo, rendering, 4 times their difference."""
    from ...gaussians.files import writing
    from ...gaussians.fit.quality import comparison
    from ..pictures.image_files import save_png

    with writing(folder / "report.json", force=force) as file:
        file.write((json.dumps(data, indent=2) + "\n").encode())
    for shot in photos.held_out:
        save_png(comparison(done.scene.cloud, shot), folder / f"{shot.camera.name}.png", force=force)
