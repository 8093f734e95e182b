"""How a body changes its shape (`Bend`): some nodes in it are displaced, and what is between them goes along.

A few nodes tell the displacements of all Gaussians, those that are added later included (embedded deformation, Sumner
et al. 2007; sparse control points, Huang et al. 2024). `low_rank` writes them as a `Residual` holds them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from .. import keys

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

MOST = 24  # nodes
EACH = 8  # Gaussians for each node, at least
REACH = 0.6  # of the distance between nodes: how far one is felt
NEIGHBOURS = 4


@dataclass(frozen=True, eq=False)
class Bend:
    """Displacements of a body's Gaussians, before the body is placed.

    Attributes:
        nodes: `[K, 3]` at the first time.
        reach: scene units, as far a node is felt.
        moves: `[T, K, 3]` displacements of the nodes at each time of the frames, scene units; the first are 0.
    """

    nodes: F64
    reach: float
    moves: F64

    @classmethod
    def none(cls, means: F32, times: int) -> Bend:
        """No displacements, of nodes that are spread over means `[N, 3]`: each is the one farthest from all before."""
        count = int(np.clip(len(means) // EACH, 1, MOST))
        chosen = [int(np.linalg.norm(means - means.mean(axis=0), axis=1).argmax())]
        away = np.full(len(means), np.inf)
        while len(chosen) < count:
            away = np.minimum(away, np.linalg.norm(means - means[chosen[-1]], axis=1))
            chosen.append(int(away.argmax()))
        nodes = means[chosen].astype(np.float64)
        apart = cKDTree(nodes).query(nodes, k=2)[0][:, 1] if count > 1 else np.ones(1)
        return cls(nodes, REACH * float(np.median(apart)), np.zeros((times, count, 3)))

    def shares(self, means: F32) -> F32:
        """`[N, K]` how far means go along with each node; each row sums to 1."""
        square = ((means[:, None, :] - self.nodes.astype(np.float32)) ** 2).sum(axis=2)
        square -= square.min(axis=1, keepdims=True)
        near = np.exp(-square / np.float32(2 * self.reach**2))
        return np.asarray(near / near.sum(axis=1, keepdims=True), np.float32)

    def displaced(self, t: int, means: F32) -> F32:
        """Means `[N, 3]` of the first time as they are at a time, before the body is placed."""
        return means + self.shares(means) @ self.moves[t].astype(np.float32)

    @cached_property
    def near(self) -> I64:
        """`[K, n]` each node's nearest others; itself where there is no other."""
        count = min(NEIGHBOURS + 1, len(self.nodes))
        found = cKDTree(self.nodes).query(self.nodes, k=count)[1].reshape(len(self.nodes), -1)
        return np.asarray(found[:, 1:] if count > 1 else found)

    def together(self, moves: F64, share: float) -> F64:
        """Displacements `[K, 3]` drawn by a share towards the mean of the neighbours of each node."""
        return moves + share * (moves[self.near].mean(axis=1) - moves)

    def with_moves(self, times: slice, moves: F64) -> Bend:
        """The bend with other displacements `[K, 3]` at some times."""
        every = self.moves.copy()
        every[times] = moves
        return replace(self, moves=every)

    def at(self, some: F64, times: F64) -> Bend:
        """The bend at other times: what is between two of `some` goes evenly from one to the other."""
        flat = self.moves.reshape(len(some), -1)
        each = np.stack([np.interp(times, some, column) for column in flat.T], axis=1)
        return replace(self, moves=each.reshape(len(times), *self.moves.shape[1:]))

    def factors(self, tolerance: float) -> tuple[F64, F64]:
        """Basis `[T, B]` and ways `[B, K, 3]` whose product is the displacements, of as low a rank as keeps the nodes
        within a tolerance (scene units) of their places, root mean square over nodes and times. The greatest of each
        column of the basis is 1."""
        flat = self.moves.reshape(len(self.moves), -1)
        left, values, right = np.linalg.svd(flat, full_matrices=False)
        left[~flat.any(axis=1)] = 0.0  # but for rounding, they are so
        for rank in range(len(values) + 1):
            rest = flat - (left[:, :rank] * values[:rank]) @ right[:rank]
            if np.sqrt((rest**2).sum() / max(rest.size / 3, 1)) <= tolerance:
                break
        most = np.abs(left[:, :rank]).max(axis=0, initial=0.0)
        ways = (values[:rank] * most)[:, None] * right[:rank]
        return left[:, :rank] / most, ways.reshape(rank, len(self.nodes), 3)

    def low_rank(self, means: F32, tolerance: float) -> tuple[F64, F32]:
        """Basis `[T, B]` and weights `[N, B, 3]` of the displacements of means `[N, 3]`; see `factors`."""
        basis, ways = self.factors(tolerance)
        weights = np.einsum("nk,bkc->nbc", self.shares(means).astype(np.float64), ways)
        return basis, weights.astype(np.float32)

    def started_at(self, t: int, turn: F64, pivot: F64, offset: F64) -> Bend:
        """The same displacements of what is where it is at a time, at which the body is placed by a pose."""
        matrix = keys.matrices(turn)
        nodes = (self.nodes + self.moves[t] - pivot) @ matrix.T + pivot + offset
        return Bend(nodes, self.reach, (self.moves - self.moves[t]) @ matrix.T)

    def backwards(self) -> Bend:
        """The same in the opposite order of times."""
        return replace(self, moves=self.moves[::-1].copy())
