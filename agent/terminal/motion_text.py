"""The motion of a scene in words and as data: what moves, how, and when."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ...gaussians.motion.motion import Track
    from ...gaussians.scene import Scene

_SHOWN = 12  # tracks that are listed


def motion_data(scene: Scene) -> dict[str, Any] | None:
    """The motion of a scene as data; None if nothing changes with time."""
    motion = scene.motion
    if motion is None:
        return None
    from ...gaussians.motion.motion import moving_ids

    return {
        "start": motion.start,
        "stop": motion.stop,
        "moving": len(moving_ids(motion)),
        "tracks": [_track(scene, track) for track in motion.tracks],
        "looks": len(motion.looks),
        "residuals": [{"gaussians": len(r.ids), "rank": r.basis.shape[1]} for r in motion.residuals],
        "bytes": motion.nbytes,
    }


def _track(scene: Scene, track: Track) -> dict[str, Any]:
    first, last = float(track.times[0]), float(track.times[-1])
    return {
        "name": track.name or _thing(scene, track),
        "kind": track.kind,
        "gaussians": len(track),
        "keys": len(track.times),
        "time": [first, None if track.kind == "spin" else last],
    }


def _thing(scene: Scene, track: Track) -> str:
    """The name of the thing that a track moves; "" if most of it belongs to none."""
    import numpy as np
    import torch

    from ...gaussians.rows import rows_of_ids

    if scene.language is None:
        return ""
    owners = scene.cloud.group[rows_of_ids(scene.cloud.ids, torch.from_numpy(track.ids))].cpu().numpy()
    owners = owners[(owners >= 0) & (owners < len(scene.language.groups))]
    if 2 * len(owners) <= len(track):
        return ""
    group = scene.language.groups[int(np.bincount(owners).argmax())]
    return (scene.language.groups[group.parent] if group.parent >= 0 else group).label


def motion_lines(data: dict[str, Any] | None) -> list[str]:
    """The same in lines; none for a static scene."""
    if data is None:
        return []
    kinds = Counter(track["kind"] for track in data["tracks"])
    tracks = ", ".join(f"{count} {kind}" for kind, count in kinds.items()) or "no tracks"
    lines = [
        f"  motion from {data['start']:g} to {data['stop']:g} s: {data['moving']:,} Gaussians move ({tracks}), "
        f"{data['bytes']:,} bytes"
    ]
    for track in data["tracks"][:_SHOWN]:
        until = "on" if track["time"][1] is None else f"to {track['time'][1]:g} s"
        lines.append(
            f"    {track['name'] or 'unnamed'}: {track['kind']}, {track['gaussians']:,} Gaussians, "
            f"{track['keys']} keys, from {track['time'][0]:g} s {until}"
        )
    if len(data["tracks"]) > _SHOWN:
        lines.append(f"    and {len(data['tracks']) - _SHOWN} more")
    if data["looks"]:
        lines.append(f"    {data['looks']} looks for a while")
    lines += [f"    {r['gaussians']:,} Gaussians move by themselves (rank {r['rank']})" for r in data["residuals"]]
    return lines
