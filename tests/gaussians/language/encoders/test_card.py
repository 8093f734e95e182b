"""The encoder card says what was measured, and nothing else."""

from __future__ import annotations

from pathlib import Path

from scenewright.gaussians.language.encoders import weights_folder
from scenewright.training import card

_PAGE = Path(__file__).resolve().parents[4] / "docs" / "encoder-card.md"


def test_the_page_is_what_the_figures_give() -> None:
    assert _PAGE.read_text(encoding="utf-8") == card.page(weights_folder()), (
        "the card is stale; run: python -m scenewright.training.card > docs/encoder-card.md"
    )


def test_the_shipped_files_are_small() -> None:
    total = sum(path.stat().st_size for path in weights_folder().iterdir())
    assert total <= 8_000_000  # what we promise to add to an installation
