"""`scenewright info SCENE`: what a file holds."""

from __future__ import annotations

from typing import Any

from ..options import Debug, Json, SceneFile
from ..terminal import terminal


def command(scene: SceneFile, as_json: Json = False, debug: Debug = False) -> None:
    """Tell what a scene file holds: format, Gaussians, frame, cameras, repairs, and its things if it was embedded."""
    from ...gaussians.files import load_with_report
    from ...gaussians.language.store import load_field

    loaded, report = load_with_report(scene)
    loaded = load_field(loaded, scene) or loaded
    cloud, frame, language = loaded.cloud, loaded.frame, loaded.language
    low, high = (getattr(cloud.means, f)(dim=0).values.tolist() for f in ("min", "max"))
    data: dict[str, Any] = {
        "path": str(scene),
        "format": report.format,
        "gaussians": len(cloud),
        "degree": cloud.degree,
        "megabytes": round(cloud.nbytes / 1e6, 1),
        "bounds": [low, high],
        "up": [frame.up, frame.up_source],
        "floor": frame.floor,
        "metres_per_unit": [frame.metres_per_unit, frame.scale_source],
        "cameras": [{"name": c.name, "size": [c.width, c.height]} for c in loaded.cameras],
        "notes": list(report.notes),
        "language": None,
    }
    if language is not None:
        things = [{"group": g.id, "label": g.label, "count": g.count} for g in language.objects() if g.count]
        data["language"] = {"encoder": language.encoder, "things": things, "notes": list(language.notes)}
    terminal.result(_text(data), data)


def _text(data: dict[str, Any]) -> str:
    low, high = data["bounds"]
    span = " x ".join(f"{b - a:.2f}" for a, b in zip(low, high, strict=True))
    scale, source = data["metres_per_unit"]
    lines = [
        f"{data['path']}: {data['format']}",
        f"  {data['gaussians']:,} Gaussians, harmonics of degree {data['degree']}, {data['megabytes']} MB in memory",
        f"  extent {span} units; " + (f"{scale:g} m a unit ({source})" if scale else "scale unknown"),
        f"  up {tuple(round(c, 3) for c in data['up'][0])} ({data['up'][1]})",
        f"  {len(data['cameras'])} cameras",
        *(f"  repaired: {note}" for note in data["notes"]),
    ]
    if data["language"] is None:
        lines.append("  not embedded yet: run `scenewright embed`")
    else:
        names = sorted(t["label"] or "unnamed thing" for t in data["language"]["things"])
        lines.append(f"  {len(names)} things: {', '.join(names)}")
        lines.append(f"  embedded with {data['language']['encoder']}")
    return "\n".join(lines)
