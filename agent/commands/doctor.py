"""`scenewright doctor`: which back ends are usable here."""

from __future__ import annotations

from ..options import Debug, Json
from ..terminal.output import terminal


def command(as_json: Json = False, debug: Debug = False) -> None:
    """List which back ends are usable on this machine and what to install for the others."""
    from ..doctor import examine, machine

    where, findings = machine(), examine()
    lines = [f"Python {where['python']} on {where['system']}, {where['cores']} cores ({where['executable']})"]
    for f in findings:
        mark = "ok " if f.usable else ("NO " if f.needed else "-  ")
        lines.append(f"{mark} {f.name:<20} {f.version:<14} {f.serves}: {f.detail}")
        if f.fix:
            lines.append(f"{'':24}-> {f.fix}")
    broken = [f.name for f in findings if f.needed and not f.usable]
    lines.append(f"not ready: {', '.join(broken)}" if broken else "ready")
    terminal.result(
        "\n".join(lines), {"machine": where, "ready": not broken, "findings": [f.to_json() for f in findings]}
    )
