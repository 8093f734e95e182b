"""Makes scenes smaller without losing more than a promised PSNR, and measures what each part of their model buys."""

from .slimming import Prepared, Settings, Slimmed, prepare, slim

__all__ = ["Prepared", "Settings", "Slimmed", "prepare", "slim"]
