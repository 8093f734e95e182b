"""`scenewright embed SCENE`: make the language field of a scene and save it beside the file."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .. import startup
from ..options import Capture, Debug, Effort, Encoder, Force, Json, Masks, Memory, Scale, SceneFile, Up
from ..terminal.effort import dialled, reported, tell
from ..terminal.output import terminal

if TYPE_CHECKING:
    from ...gaussians.language.field.language_field import LanguageField
    from ...gaussians.scene import Scene
    from ...gaussians.tiles.store import Tiles


def command(
    scene: SceneFile,
    encoder: Encoder = "auto",
    masks: Masks = None,
    capture: Capture = None,
    up: Up = None,
    metres_per_unit: Scale = None,
    effort: Effort = None,
    memory: Memory = None,
    force: Force = False,
    as_json: Json = False,
    debug: Debug = False,
) -> None:
    """Make the language field of a scene and save it beside the file, so that later commands need not embed again.

    A saved field is used as long as the scene file has not changed; another --encoder names its groups anew. --force
    embeds again, and so do --masks, --capture and --effort, and --up and --metres-per-unit, which are saved with the
    field.

    --capture names the photographs that the scene was fitted from: what belongs together is then also read from them,
    and an encoder that was trained on photographs is shown crops of them instead of renders.

    A scene in tiles is embedded tile by tile, each with what is around it, and keeps its table in its folder; what was
    stopped goes on where it stopped.
    """
    started = time.perf_counter()
    from ...gaussians.files import load
    from ...gaussians.files.captures.capture import read_capture
    from ...gaussians.language import encoders
    from ...gaussians.language import masks as maskers
    from ...gaussians.language.field.embed import embed
    from ...gaussians.language.field.group_table import renamed
    from ...gaussians.language.field.store import load_field, mismatch
    from ...gaussians.tiles.store import Tiles, is_tiles
    from ..pictures.named_cameras import with_frame

    startup.end()
    dial = dialled(effort, started)
    tiles = Tiles.open(scene) if is_tiles(scene) else None
    if tiles is not None and _by_blocks(tiles, {"--masks": masks, "--capture": capture, "--effort": effort}):
        _embed_blocks(tiles, encoder, up, metres_per_unit, force, started)
        return
    loaded, chosen = load(scene), encoders.load(encoder)
    loaded = with_frame(loaded, up, metres_per_unit)
    again = force or any(said is not None for said in (up, metres_per_unit, masks, capture, effort))
    taken = None if capture is None else read_capture(capture)
    if taken is not None and not loaded.cameras:
        loaded = loaded.replace(cameras=taken.cameras)
    sources, notes = maskers.load_all(masks, capture)
    if dial is not None and masks is None:
        sources = ()  # the dial chooses them
    elif dial is not None:
        dial.overrule("--masks")
    for note in notes:
        terminal.say(f"note: {note}")
    known = None if again else load_field(loaded, scene)
    if known is None and not again and (why := mismatch(scene)) is not None:
        terminal.say(f"note: the language field beside {scene} {why}: embedding again")
    embedded = known or embed(loaded, chosen, progress=terminal.progress, masks=sources, capture=taken, effort=dial)
    language = embedded.language
    assert language is not None
    other = language.encoder != chosen.fingerprint
    if other:
        embedded = renamed(embedded, chosen)
        language = embedded.language
        assert language is not None
    path = None if known and not other else _saved(embedded, scene, tiles)
    seconds = round(time.perf_counter() - started, 2)
    done = f"embedded in {seconds} s, saved as {path}"
    if other:
        done = f"the same groups, named by another encoder in {seconds} s, saved as {path}"
    elif known:
        done = "was embedded already (--force does it again)"
    data = _data(language, path, seconds) | {"was_there": known is not None, "renamed": other}
    terminal.result(_text(scene, done, language), data | reported(dial))
    tell(dial)


def _data(language: LanguageField, path: Path | None, seconds: float) -> dict[str, Any]:
    things = [
        {"group": g.id, "label": g.label, "sure": round(g.label_score, 3), "gaussians": g.count}
        for g in language.objects()
    ]
    return {
        "path": str(path) if path else None,
        "things": things,
        "encoder": language.encoder,
        "notes": list(language.notes),
        "seconds": seconds,
    }


def _text(scene: Path, done: str, language: LanguageField) -> str:
    from ..terminal.thing_names import describe_things

    return "\n".join([f"{scene}: {done}", describe_things(language.objects()), *language.notes])


def _by_blocks(tiles: Tiles, given: dict[str, object]) -> bool:
    """Whether a scene in tiles is embedded block by block.

    Raises:
        UserError: it is, and an option is given that needs all of it at once.
    """
    from ...gaussians.errors import UserError
    from ...gaussians.tiles.budget import memory
    from ...gaussians.tiles.embedding import BYTES, fits_whole

    if fits_whole(tiles, memory()):
        return False
    said = [name for name, value in given.items() if value is not None]
    if said and len(tiles) * BYTES > memory():
        raise UserError(
            f"{said[0]} needs all of a scene at once, here some {len(tiles) * BYTES / 1e9:.1f} GB; allow them with "
            "--memory, or give it when the files are embedded, then tile them"
        )
    return not said


def _embed_blocks(
    tiles: Tiles, encoder: str, up: str | None, metres_per_unit: float | None, force: bool, started: float
) -> None:
    """Embed a scene in tiles block by block, unless it is embedded."""
    from ...gaussians.cloud import GaussianCloud
    from ...gaussians.errors import UserError
    from ...gaussians.language import encoders
    from ...gaussians.tiles.budget import memory
    from ...gaussians.tiles.embedding import embed_tiles
    from ..pictures.named_cameras import with_frame

    chosen = encoders.load(encoder)
    field, again = tiles.field, force or up is not None or metres_per_unit is not None
    if field is not None and not again:
        if field.encoder != chosen.fingerprint:
            raise UserError(
                f"these tiles were embedded by {field.encoder}; --force embeds them by {chosen.fingerprint}"
            )
        data = _data(field, None, 0.0) | {"was_there": True, "renamed": False}
        terminal.result(_text(tiles.folder, "was embedded already (--force does it again)", field), data)
        return
    frame = with_frame(tiles.scene(GaussianCloud.empty(tiles.state.degree)), up, metres_per_unit).frame
    done = embed_tiles(tiles, chosen, memory(), frame, progress=terminal.progress)
    terminal.clear()
    assert done.field is not None
    seconds = round(time.perf_counter() - started, 2)
    data = _data(done.field, tiles.folder, seconds) | {"was_there": False, "renamed": False}
    terminal.result(_text(tiles.folder, f"embedded in {seconds} s", done.field), data)


def _saved(embedded: Scene, path: Path, tiles: Tiles | None) -> Path:
    """Save the field of a scene beside its file, or in its folder if that holds tiles; returns where it is.

    Args:
        tiles: as they were when the scene was read: what another program changed since then is not overwritten.
    """
    from ...gaussians.language.field.store import save_field
    from ...gaussians.tiles import changing

    if tiles is None:
        return save_field(embedded, path)
    changing.embed(tiles, embedded, "embed")
    return path
