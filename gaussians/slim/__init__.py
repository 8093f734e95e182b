"""Makes scenes smaller without losing more than a promised PSNR, and measures what each part of their model buys."""

from .slimming import Settings, Slimmed, slim

__all__ = ["Settings", "Slimmed", "slim"]
