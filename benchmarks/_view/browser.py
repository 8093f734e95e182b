"""A real browser that draws WebGL in software, driven by Playwright; the tests of the page use it too."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Literal

from ...gaussians.errors import BackendError

CHROMIUM = Path(os.environ.get("SCENEWRIGHT_CHROMIUM", "/usr/bin/chromium"))
SWITCHES = [
    "--no-sandbox", "--ignore-gpu-blocklist",
    "--disable-background-networking", "--disable-component-update", "--disable-sync", "--no-first-run",
]  # fmt: skip
Driver = Literal["swiftshader", "llvmpipe"]
DRIVERS: tuple[Driver, ...] = ("swiftshader", "llvmpipe")  # the browser's own, and Mesa's
_DRAW_BY: dict[Driver, list[str]] = {
    "swiftshader": ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
    "llvmpipe": ["--use-gl=angle", "--use-angle=gl-egl"],
}
_MESA = {"LIBGL_ALWAYS_SOFTWARE": "1", "EGL_PLATFORM": "surfaceless"}


@contextmanager
def chromium(driver: Driver = "swiftshader") -> Iterator[Any]:
    """A browser, closed at the end of the block.

    Args:
        driver: what draws WebGL.

    Raises:
        BackendError: there is no browser, or Playwright is not installed.
    """
    try:
        from playwright.sync_api import sync_playwright
    except ModuleNotFoundError as error:
        raise BackendError("the package playwright drives the browser; run: pip install playwright") from error
    if not CHROMIUM.exists():
        raise BackendError(f"there is no browser at {CHROMIUM}; install chromium, or name one in SCENEWRIGHT_CHROMIUM")
    with sync_playwright() as running:
        opened = running.chromium.launch(
            executable_path=CHROMIUM, args=[*SWITCHES, *_DRAW_BY[driver]], env={**os.environ, **_MESA}
        )
        try:
            yield opened
        finally:
            opened.close()
