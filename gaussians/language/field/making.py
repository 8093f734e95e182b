"""`Making`: what a language field was made with: encoder, sources of masks, views, and versions."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

from ... import language

RULES = ("affinity.json", "borders.json", "coplanar.json")  # the learnt rules of the segmentation


@dataclass(frozen=True)
class MaskSource:
    """A source of masks and what it gave.

    Attributes:
        spec: as `masks.load` takes it ("folder:PATH"), or the name of its class.
        views: number of images that it gave masks of.
        masks: number of masks.
        agreement: how far its views agree with each other about what is one thing, in [0, 1], and so how far one
            of them is believed, see `masks.reliability.agreement_of`; None if it gave no masks.
    """

    spec: str
    views: int = 0
    masks: int = 0
    agreement: float | None = None

    def describe(self) -> str:
        """ "folder:masks: 512 masks of 146 images, whose views agree to 81% and are believed as far"."""
        told = f"{self.spec}: {self.masks} masks of {self.views} images"
        return (
            told
            if self.agreement is None
            else f"{told}, whose views agree to {self.agreement:.0%} and are believed as far"
        )


@dataclass(frozen=True)
class Making:
    """What a language field was made with.

    Attributes:
        encoder: the encoder of vectors and names, as `encoders.load` takes it, or the name of its class.
        masks: the sources of masks; empty for a field from geometry alone.
        views: number of rendered views that coverage was judged by.
        photographs: number of photographs that pictures of groups were taken from, 0 for renders.
        package: version of scenewright.
        rules: digest of the learnt rules of the segmentation.
        scale: metres per unit estimated from things that are named surely, for judging sizes; None if the scale of the
            scene is known or nothing tells it.
        trust: how far pictures of this scene are trusted to give names, in [0, 1], see `posterior`; None if not known.
    """

    encoder: str
    masks: tuple[MaskSource, ...] = ()
    views: int = 0
    photographs: int = 0
    package: str = ""
    rules: str = ""
    trust: float | None = None
    scale: float | None = None

    def lines(self) -> list[str]:
        """The making as lines for a person."""
        found = [f"named by the encoder {self.encoder}; scenewright {self.package}, rules {self.rules}"]
        if self.trust is not None:
            found.append(f"its pictures are trusted with {self.trust:.0%}")
        found += [f"masks from {source.describe()}" for source in self.masks]
        return found + ([f"pictures of things from {self.photographs} photographs"] if self.photographs else [])


@cache
def rules_digest() -> str:
    """First 12 hex digits of the SHA-256 of the learnt rules, which tells versions of them apart."""
    folder = files(language) / "segmentation"
    digest = hashlib.sha256()
    for name in RULES:
        digest.update((folder / name).read_bytes())
    return digest.hexdigest()[:12]


def package_version() -> str:
    """The version of this package."""
    from .... import __version__

    return __version__
