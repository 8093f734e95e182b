"""From Gaussians to groups: surface points, superpoints, planes, the merge tree and its cut."""
