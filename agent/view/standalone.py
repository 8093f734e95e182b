"""One HTML file that shows a scene without a server or a network: the renderer and the scene's columns inside it.

Modules are entries of an import map, as data addresses; the worker starts from a blob; the scene is the messages of a
load (docs/view-protocol.md), each packed with gzip and written as base64. Where something moves, messages of moments
follow. Scripts are allowed by their digests.
"""

from __future__ import annotations

import base64
import gzip
import hashlib
import html
import json
import re
from pathlib import Path

from ...gaussians.camera import Camera
from ...gaussians.scene import Scene
from . import state, wire
from .changes import Shown
from .frames import moments

_FOLDER = Path(__file__).parent
_VIEWER = _FOLDER / "page" / "viewer"
_IMPORT = re.compile(r"""(from\s+|import\s+)'\./([\w.]+)'""")
_LEVEL = 6  # of gzip: higher ones gain under a percent and take several times as long


def page(scene: Scene, camera: Camera, title: str) -> bytes:
    """The file, UTF-8.

    Args:
        camera: the view that it opens with; also "Home".
        title: what the page is called.
    """
    modules = {p.name: p.read_text("utf-8") for p in _VIEWER.glob("*.js") if p.name != "sort_worker.js"}
    addresses = {_bare(name): _address(source) for name, source in sorted(modules.items())}
    scripts = {
        "importmap": json.dumps({"imports": addresses}),
        "module": _renamed((_FOLDER / "exported" / "main.js").read_text("utf-8")),
    }
    shown = Shown.first(scene)
    blocks = [f'<script type="text/plain" class="columns">{_packed(m)}</script>' for m in wire.load(shown)]
    blocks += [
        f'<script type="text/plain" class="moments" data-time="{time:.6g}">{_packed(m)}</script>'
        for time, m in moments(shown)
    ]
    about = state.about(scene, camera, title) | {"names": state.names(scene)}
    filled = {
        "title": html.escape(title),
        "scripts": " ".join(_digest(source) for source in scripts.values()),
        "about": json.dumps(about).replace("<", "\\u003c"),
        "worker": (_VIEWER / "sort_worker.js").read_text("utf-8"),
        "messages": "\n".join(blocks),
        "modules": "\n".join(f'<script type="{kind}">{source}</script>' for kind, source in scripts.items()),
    }
    frame = (_FOLDER / "exported" / "page.html").read_text("utf-8")
    return re.sub(r"\{\{(\w+)\}\}", lambda match: filled[match[1]], frame).encode()


def _packed(message: bytes) -> str:
    return base64.b64encode(gzip.compress(message, _LEVEL, mtime=0)).decode()


def _bare(name: str) -> str:
    """The name of a module in the import map: a data address has no folder that "./" could mean."""
    return f"viewer/{name}"


def _renamed(source: str) -> str:
    return _IMPORT.sub(lambda match: f"{match[1]}'{_bare(match[2])}'", source)


def _address(source: str) -> str:
    return f"data:text/javascript;base64,{base64.b64encode(_renamed(source).encode()).decode()}"


def _digest(source: str) -> str:
    """A script's source in a Content-Security-Policy."""
    return f"'sha256-{base64.b64encode(hashlib.sha256(source.encode()).digest()).decode()}'"
