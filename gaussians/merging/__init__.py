"""Merges Gaussians into fewer ones of the same mass: levels of detail, and scenes with fewer Gaussians."""

from .pairwise import Merged, masses, merge, merged_by, visibility

__all__ = ["Merged", "masses", "merge", "merged_by", "visibility"]
