"""Lift pictures into a fill: its new Gaussians are optimised against photographs, or what a model inpainted."""
