"""`slim`: the smallest file of a scene that loses at most what was promised, measured from views that chose nothing."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from ..camera import Camera
from ..effort import Dial, Effort
from ..errors import CheckFailedError, UserError
from ..scene import Scene
from .encoding import Files
from .importance import Progress
from .loss import EXACT, Loss
from .preparing import Prepared, Settings, prepare
from .reductions import Strength
from .report import same_thing
from .search import Search

EXACT_FORMATS = (".ply",)  # which return every bit


@dataclass(frozen=True, eq=False)
class Slimmed:
    """A scene made smaller.

    Attributes:
        scene: rows as they are in the file; ids are those of the original.
        data: the file's bytes.
        strength: what was left out; None if nothing was.
        choice, held_out: loss from the views that chose and from those that did not; None if nothing was lost.
        alone: loss of the format alone, from the held-out views; None if nothing was lost.
        raised: how often the held-out views lost more than promised and a weaker setting was taken.
        cameras: where the views come from.
        same_thing: share of the held-out pixels that show the same thing of the language field as before.
        steps: of the optimisation.
        tried: settings tried, as (strength, bytes, dB from the chosen views), in the order tried.
    """

    scene: Scene
    data: bytes
    strength: Strength | None
    choice: Loss | None
    held_out: Loss | None
    alone: Loss | None
    raised: int = 0
    cameras: str = ""
    same_thing: float | None = None
    steps: int = 0
    tried: tuple[tuple[Strength, int, float], ...] = ()


def slim(
    scene: Scene,
    suffix: str,
    settings: Settings,
    cameras: Sequence[Camera] = (),
    progress: Progress | None = None,
    prepared: Prepared | None = None,
    *,
    effort: Effort | Dial | None = None,
) -> Slimmed:
    """The smallest file found whose pictures keep `settings.psnr` dB from the held-out views. Same input, same bytes.

    Args:
        suffix: of the file format, with dot: ".sog", ".spz", ".compressed.ply", ".ply".
        cameras: of photographs of the scene; computed views are used without them.
        progress: called with the stage and its share.
        prepared: what `prepare` gave for this scene; its views are used.
        effort: "fast", "balanced", "accurate", or seconds. There is one measured point, so that it only predicts and
            reports; an optimisation of `settings` wins.

    Raises:
        UserError: the format cannot be written, or no view shows anything.
        CheckFailedError: the format alone loses more than promised; the message says what it keeps.
    """
    if len(scene.cloud) == 0:
        raise UserError("there is nothing to make smaller: the scene holds zero Gaussians")
    say = progress or (lambda stage, share: None)
    if effort is not None:
        dial = effort if isinstance(effort, Dial) else Dial(effort)
        if settings.steps is None and settings.seconds is None:
            dial.choose("slim", len(scene.cloud))
        else:
            dial.overrule("an optimisation")
    with tempfile.TemporaryDirectory() as folder:
        files = Files(Path(folder), suffix)
        if settings.psnr >= EXACT:
            return _unchanged(scene, files, suffix)
        ready = prepared or prepare(scene, cameras, settings.size, say)
        search = Search(scene, suffix, settings, ready, files, say)
        best, alone = search.run()
        back = files.decode(best.data)
        back = back.replace(cloud=back.cloud.replace(group=best.scene.cloud.group))
        views = ready.views
        return Slimmed(
            best.scene, best.data, best.strength, best.loss, ready.held_out.loss(back.cloud), alone, search.raised,
            views.source, same_thing(scene, back, views.held_out), search.steps, tuple(search.tried),
        )  # fmt: skip


def _unchanged(scene: Scene, files: Files, suffix: str) -> Slimmed:
    """The same scene, for a promise that nothing is lost."""
    if suffix not in EXACT_FORMATS:
        raise CheckFailedError(f"{suffix} files always lose something; only .ply keeps every bit: write NAME.ply")
    return Slimmed(scene, files.encode(scene), None, None, None, None)
