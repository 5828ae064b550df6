"""A bounding volume hierarchy over a scene's triangles, laid out for a shader without a stack."""

from dataclasses import dataclass

import numpy as np

LEAF = 4  # triangles in a leaf
NOWHERE = 1e30  # further than any ray is followed


@dataclass(frozen=True, eq=False)
class Bvh:
    """Nodes depth first: after a node comes its first child, or, where it is missed, its `skip`.

    Attributes:
        nodes: (n, 2, 4) float32; the least corner of the box and the node's `skip`, the greatest
            corner and the first of a leaf's triangles, or -1.
        order: (m,) the triangles as the leaves hold them, LEAF each; -1 pads the last leaves.
    """

    nodes: np.ndarray
    order: np.ndarray


def build(corners: np.ndarray) -> Bvh:
    """A balanced tree over triangles (n, 3, 3): halves by the median along the longest side."""
    depth = max(int(np.ceil(np.log2(max(len(corners) / LEAF, 1)))), 0)
    slots = LEAF << depth
    low, high = corners.min(axis=1), corners.max(axis=1)
    middle = (low + high) / 2
    order = np.concatenate([np.arange(len(corners)), np.full(slots - len(corners), -1)])
    # Padding lies beyond everything, so that it gathers in the last leaves.
    at = np.where(order[:, None] >= 0, middle[order], np.inf)
    for level in range(depth):
        parts = at.reshape(1 << level, -1, 3)
        held = np.isfinite(parts)
        high_end = np.where(held, parts, -np.inf).max(axis=1)
        spread = high_end - parts.min(axis=1)  # of a part that is empty -inf, on every axis
        key = np.take_along_axis(parts, spread.argmax(axis=1)[:, None, None], axis=2)[..., 0]
        turn = np.argsort(key, axis=1, kind="stable")
        turn += np.arange(1 << level)[:, None] * key.shape[1]
        order, at = order[turn.ravel()], at[turn.ravel()]
    low = np.where(order[:, None] >= 0, low[order], np.inf).reshape(-1, LEAF, 3).min(axis=1)
    high = np.where(order[:, None] >= 0, high[order], -np.inf).reshape(-1, LEAF, 3).max(axis=1)
    return Bvh(_depth_first(low, high, depth), order)


def _depth_first(low: np.ndarray, high: np.ndarray, depth: int) -> np.ndarray:
    """Nodes from the boxes of the leaves, (2^depth, 3) each."""
    levels = [(low, high)]
    for _ in range(depth):
        low, high = low.reshape(-1, 2, 3).min(axis=1), high.reshape(-1, 2, 3).max(axis=1)
        levels.append((low, high))
    nodes = np.zeros(((2 << depth) - 1, 2, 4), np.float32)
    index = np.zeros(1, int)
    for level, (low, high) in enumerate(reversed(levels)):
        size = (2 << (depth - level)) - 1  # of the subtree
        empty = ~(low <= high)
        nodes[index, 0, :3] = np.where(empty, NOWHERE, low)
        nodes[index, 1, :3] = np.where(empty, NOWHERE, high)
        nodes[index, 0, 3], nodes[index, 1, 3] = index + size, -1
        if level < depth:
            index = np.stack([index + 1, index + 1 + size // 2], axis=1).ravel()
    nodes[index, 1, 3] = np.arange(len(index)) * LEAF
    return nodes
