"""Builds one asset: mesh pieces, materials, patterns, sampling to Gaussians and baked lighting."""
