"""The tables of `info --budget`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .tables import table

if TYPE_CHECKING:
    from ...gaussians.slim.budget import Budget, Row

EXACT = 120.0  # dB that equal pictures are reported with


def budget_text(found: Budget) -> str:
    """The parts of a scene's model with their bytes and what dropping them loses."""
    lines = [
        f"{found.gaussians:,} Gaussians, {_size(found.bytes)} as .ply; measured from {found.views} views, "
        f"{found.cameras}; {found.unseen:.1%} of the Gaussians are seen from none",
        table(("part", "without", "saves", "share", "keeps"), [_cells(row) for row in found.rows], 120),
    ]
    if found.field_bits:
        columns = ", ".join(f"{name} {bits:.2f}" for name, bits in found.field_bits.items())
        lines.append(
            f"language field: {sum(found.field_bits.values()):.1f} bits a Gaussian ({columns}); a vector for each "
            f"Gaussian would take {found.vector_bits:,.0f}, and finer vectors find names no better (docs/slim.md)"
        )
    return "\n".join(lines)


def _cells(row: Row) -> tuple[str, str, str, str, str]:
    keeps = "-"
    if row.psnr is not None:
        keeps = "every bit" if row.psnr >= EXACT else f"{row.psnr:.1f} dB"
    elif row.kept is not None:
        keeps = f"{row.kept:.1%} of the {'names' if row.part == 'vectors' else 'Gaussians seen'}"
    return row.part, row.what, _size(row.bytes) if row.bytes else "-", f"{row.share:.0%}", keeps


def _size(count: int) -> str:
    return f"{count / 1e6:.2f} MB" if count >= 1e5 else f"{count:,} B"
