"""Makes scenes smaller without losing more than a promised PSNR, and measures what each part of their model buys."""

from .preparing import Prepared, Settings, prepare
from .slimming import Slimmed, slim

__all__ = ["Prepared", "Settings", "Slimmed", "prepare", "slim"]
