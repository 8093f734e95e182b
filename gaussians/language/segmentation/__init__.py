"""Segmentation of Gaussians into groups: surface points, superpoints, planes, merge tree, objects and parts."""
