"""`scenewright embed SCENE`: make the language field of a scene and save it beside the file."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING

from ..options import Capture, Debug, Effort, Encoder, Force, Json, Masks, Scale, SceneFile, Up
from ..terminal.effort import dialled, reported, tell
from ..terminal.output import terminal

if TYPE_CHECKING:
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
    from ..terminal.thing_names import describe_things

    dial = dialled(effort, started)
    tiles = Tiles.open(scene) if is_tiles(scene) else None
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
    things = [
        {"group": g.id, "label": g.label, "sure": round(g.label_score, 3), "gaussians": g.count}
        for g in language.objects()
    ]
    seconds = round(time.perf_counter() - started, 2)
    data = {
        "path": str(path) if path else None,
        "things": things,
        "encoder": language.encoder,
        "notes": list(language.notes),
        "seconds": seconds,
        "was_there": known is not None,
        "renamed": other,
    }
    done = f"embedded in {seconds} s, saved as {path}"
    if other:
        done = f"the same groups, named by another encoder in {seconds} s, saved as {path}"
    elif known:
        done = "was embedded already (--force does it again)"
    text = "\n".join([f"{scene}: {done}", describe_things(language.objects()), *language.notes])
    terminal.result(text, data | reported(dial))
    tell(dial)


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
