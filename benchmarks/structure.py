"""bench structure: size of the product, imports between its packages, and what one instruction touches.

Counts are of the source tree that runs. A walk is one call after a warm-up: the files and functions of the product that
Python enters on the calling thread, and how often execution moves from one top-level package to another.
"""

from __future__ import annotations

import ast
import sys
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from types import FrameType
from typing import Any, NamedTuple

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from ..agent.session.session import Session
from ..gaussians.assets import furnish
from ..planners.compose.api import compose
from .harness import Metric, Result

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = ("agent", "gaussians", "planners", "prompts", "tools")
SEED = 1


def run(quick: bool) -> Result:
    """Count files, lines and imports, and walk through an edit, a selection and a composed room."""
    modules = product()
    edges = [(a, b) for a, path in modules.items() for b in imported(a, path, modules)]
    lines = sum(len(path.read_text("utf-8").splitlines()) for path in modules.values())
    flat = max(len(list(folder.glob("*.py"))) for folder in {path.parent for path in modules.values()})
    metrics = [
        Metric("product.files", len(modules), "count", "lower", 0.05),
        Metric("product.lines", lines, "count", "lower", 0.05),
        Metric("product.largest folder", flat, "files", "lower", 0.2),
        Metric("imports", len(edges), "count", "lower", 0.05),
        Metric("imports.between folders", sum(_folder(a) != _folder(b) for a, b in edges), "count", "lower", 0.05),
        Metric("imports.cycles", len(cycles(modules, edges)), "count", "lower", goal=0),
    ]
    for name, action in walks().items():
        walk = Walk()
        walk.take(action)
        metrics += [
            Metric(f"walk.{name}.files", len(walk.files), "count", "lower", 0.1),
            Metric(f"walk.{name}.functions", len(walk.functions), "count", "lower", 0.1),
            Metric(f"walk.{name}.package changes", walk.changes, "count", "lower", 0.2),
        ]
    return Result(
        "size of the product, imports, and what one instruction touches", "", tuple(metrics), (), seeds=(SEED,)
    )


def walks() -> dict[str, Callable[[], Any]]:
    """What is walked, each warmed up once, so that neither imports nor compilation count."""
    room = furnish(SEED).scene
    embedded = Session(room)
    embedded.select("the sofa")
    scene = embedded.scene
    actions: dict[str, Callable[[], Any]] = {
        "edit": lambda: Session(scene).do("make the armchair teal"),
        "embed and edit": lambda: Session(room).do("make the armchair teal"),
        "select": lambda: Session(scene).select("the red armchair left of the coffee table"),
        "compose": lambda: compose("a minimalist home office"),
        "compose and build": lambda: compose("a minimalist home office").build(),
    }
    for action in actions.values():
        action()
    return actions


class Walk:
    """What a call enters: `files`, `functions` as (file, qualified name), and `changes` of top-level package."""

    def __init__(self) -> None:
        self.files, self.functions, self.changes = set[str](), set[tuple[str, str]](), 0
        self._package = ""
        self._known: dict[str, str] = {}

    def take(self, action: Callable[[], Any]) -> None:
        """Call `action` and record it."""
        sys.setprofile(self._entered)
        try:
            action()
        finally:
            sys.setprofile(None)

    def _entered(self, frame: FrameType, event: str, argument: object) -> None:
        if event != "call" or not (file := self._file(frame.f_code.co_filename)):
            return
        self.files.add(file)
        if not frame.f_code.co_name.startswith("<"):
            self.functions.add((file, frame.f_code.co_qualname))
        package = file.split("/")[0]
        self.changes += bool(self._package) and package != self._package
        self._package = package

    def _file(self, name: str) -> str:
        """A product file relative to the root; "" for any other."""
        if name not in self._known:
            path = Path(name).resolve()
            parts = path.relative_to(ROOT).parts if path.is_relative_to(ROOT) else ("",)
            self._known[name] = "/".join(parts) if parts[0] in PACKAGES else ""
        return self._known[name]


def product() -> dict[str, Path]:
    """Every module of the product by its dotted name below `scenewright`."""
    paths = (path for package in PACKAGES for path in sorted((ROOT / package).rglob("*.py")))
    return {".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__"): path for path in paths}


class Import(NamedTuple):
    """An import statement: `import a.b` has the names `("a.b",)` and no module, `from ..a import b` has the level 2."""

    line: int
    level: int
    module: str
    names: tuple[str, ...]


class Source(NamedTuple):
    """What a module says first, and its import statements, wherever in it they are."""

    docstring: str | None
    imports: tuple[Import, ...]


@cache
def source(path: Path) -> Source:
    """A module read once. Only statements are visited: no expression holds an import."""
    tree = ast.parse(path.read_text("utf-8"))
    found: list[Import] = []
    waiting: list[ast.AST] = [tree]
    while waiting:
        node = waiting.pop()
        if isinstance(node, ast.Import | ast.ImportFrom):
            module, level = (node.module or "", node.level) if isinstance(node, ast.ImportFrom) else ("", 0)
            found.append(Import(node.lineno, level, module, tuple(alias.name for alias in node.names)))
        for block in ("body", "orelse", "finalbody", "handlers", "cases"):
            inner = getattr(node, block, None)
            if isinstance(inner, list):  # a lambda and a choice have an expression there
                waiting += inner
    return Source(ast.get_docstring(tree), tuple(found))


def imported(name: str, path: Path, modules: dict[str, Path]) -> Iterator[str]:
    """Modules of the product that a module imports, anywhere in it, each once."""
    package = name.split(".") if path.name == "__init__.py" else name.split(".")[:-1]
    found = set[str]()
    for statement in source(path).imports:
        if statement.level:
            base = [*package[: len(package) - statement.level + 1], *statement.module.split(".")]
            target = ".".join(part for part in base if part)
            for imports in statement.names:
                nested = f"{target}.{imports}" if target else imports
                found.add(nested if nested in modules else target)
    yield from sorted(found & modules.keys() - {name})


def cycles(modules: dict[str, Path], edges: list[tuple[str, str]]) -> list[list[str]]:
    """Groups of modules that import each other, imports within functions included."""
    names = sorted(modules)
    row = {name: i for i, name in enumerate(names)}
    pairs = np.array([(row[a], row[b]) for a, b in edges]).reshape(-1, 2)
    graph = csr_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(names), len(names)))
    count, member = connected_components(graph, directed=True, connection="strong")
    groups = [[names[i] for i in np.flatnonzero(member == k)] for k in range(count)]
    return [group for group in groups if len(group) > 1]


def _folder(module: str) -> str:
    return module.rpartition(".")[0]
