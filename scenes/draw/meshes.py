"""Meshes drawn at random: smooth and creased, convex and hollow, of 500 to 200,000 triangles."""

from collections.abc import Callable

import numpy as np
import trimesh

from scenes.draw.dice import Rng, one_of, rounded, within
from scenes.draw.noise import noise
from scenes.draw.surfaces import box, creased, tube

BITS = 20  # significant in a coordinate
TAU = 2 * np.pi


def draw_mesh(kind: str, rng: Rng, triangles: int) -> trimesh.Trimesh:
    """A closed mesh in the unit sphere about the origin, of about so many triangles.

    Its normals are to be stored with it: where it has edges its vertices are split.

    Args:
        kind: one of KINDS.
    """
    mesh = KINDS[kind](rng, triangles)
    vertices = mesh.vertices - mesh.bounds.mean(axis=0)
    vertices /= np.linalg.norm(vertices, axis=1).max()
    normals = rounded(mesh.vertex_normals, BITS)
    return trimesh.Trimesh(
        rounded(vertices, BITS), mesh.faces, vertex_normals=normals, process=False
    )


def torus(rng: Rng, triangles: int) -> trimesh.Trimesh:
    """A ring, thin to fat, of round or oval section."""
    turn, wheel = _grid(triangles, 3)
    thick = np.array([within(rng, 0.15, 0.6), within(rng, 0.15, 0.6)])
    reach = 1 + thick[0] * np.cos(wheel)
    points = [reach * np.cos(turn), reach * np.sin(turn), thick[1] * np.sin(wheel)]
    return tube(np.stack(points, axis=2))


def knot(rng: Rng, triangles: int) -> trimesh.Trimesh:
    """A tube along a torus knot: it hides and mirrors itself everywhere."""
    p, q = one_of(rng, (2, 3), (3, 2), (2, 5), (3, 4))
    turn, wheel = _grid(triangles, 10)
    radius = within(rng, 0.5, 0.85) / max(p, q)
    big, small = turn * p, turn * q
    outwards = np.stack(
        [np.cos(small) * np.cos(big), np.cos(small) * np.sin(big), np.sin(small)], 2
    )
    ring = np.stack([np.cos(big), np.sin(big), np.zeros_like(big)], axis=2)
    line = ring + 0.45 * outwards
    around = np.stack([-np.sin(big), np.cos(big), np.zeros_like(big)], axis=2)
    up = np.stack([-np.sin(small) * np.cos(big), -np.sin(small) * np.sin(big), np.cos(small)], 2)
    forward = p * (1 + 0.45 * np.cos(small))[..., None] * around + 0.45 * q * up
    side = np.cross(outwards, forward)
    side /= np.linalg.norm(side, axis=2, keepdims=True)
    return tube(
        line + radius * (np.cos(wheel)[..., None] * outwards + np.sin(wheel)[..., None] * side)
    )


def capsule(rng: Rng, triangles: int) -> trimesh.Trimesh:
    """A cylinder with round ends."""
    n = max(round((triangles / 4) ** 0.5), 6)
    polar = np.linspace(np.pi, 0, n)
    shift = within(rng, 0.3, 1.5) * np.where(polar > np.pi / 2, -1, 1)
    return _turned(np.sin(polar), np.cos(polar) + shift, triangles)


def bowl(rng: Rng, triangles: int) -> trimesh.Trimesh:
    """A bowl, cup or vase: hollow, with a wall, a flat foot and a round rim."""
    n = max(round((triangles / 8) ** 0.5), 8)
    rise = np.linspace(0, 1, n)
    foot, wall, tall = within(rng, 0.3, 0.8), within(rng, 0.05, 0.12), within(rng, 0.6, 2.0)
    belly = within(rng, -0.25, 0.35) * np.sin(np.pi * rise)
    outer = foot + (1 - foot) * rise ** within(rng, 0.4, 1.5) + belly
    rim = np.linspace(0, np.pi, max(n // 3, 4))[1:-1]
    lift = wall + (tall - wall) * rise  # the floor inside lies as high as the wall is thick
    radius = [[0], outer, outer[-1] - wall / 2 * (1 - np.cos(rim)), (outer - wall)[::-1], [0]]
    height = [[0], tall * rise, tall + wall / 2 * np.sin(rim), lift[::-1], [wall]]
    return creased(_turned(np.concatenate(radius), np.concatenate(height), triangles))


def rounded_box(rng: Rng, triangles: int) -> trimesh.Trimesh:
    """A box with round edges, sharp to soft."""
    size = np.array([within(rng, 0.4, 1) for _ in range(3)])
    radius = within(rng, 0.1, 0.9) * size.min()
    segments = max(round((triangles / 12) ** 0.5), 5)
    n = round(0.4 * segments)  # in each round edge; the rest in the flat between them
    arc = np.tan(np.linspace(0, np.pi / 4, n + 1)) * radius
    sides = []
    for half in size:
        flat = np.linspace(radius - half, half - radius, segments - 2 * n + 1)[1:-1]
        sides.append(np.concatenate([-(half - radius + arc)[::-1], flat, half - radius + arc]))
    mesh = box(*sides)
    core = np.clip(mesh.vertices, radius - size, size - radius)
    out = mesh.vertices - core
    mesh.vertices = core + radius * out / np.linalg.norm(out, axis=1, keepdims=True)
    return mesh


def dented(rng: Rng, triangles: int) -> trimesh.Trimesh:
    """A stone: a sphere pushed in and out at several scales."""
    mesh = _ball(triangles)
    depth = within(rng, 0.03, 0.2)
    dents = noise(rng, mesh.vertices, within(rng, 1, 3), int(rng.integers(1, 5)), 0.45)
    mesh.vertices = mesh.vertices * np.exp(depth * np.clip(dents, -3, 3))[:, None]
    return mesh


def gear(rng: Rng, triangles: int) -> trimesh.Trimesh:
    """A toothed wheel with a bore: flat faces, sharp edges, narrow gaps. It has 40 triangles a
    tooth at least."""
    teeth = int(rng.integers(7, 23))
    bore, depth, thick = within(rng, 0.2, 0.6), within(rng, 0.08, 0.25), within(rng, 0.1, 0.8)
    # Foot, flank, tip, flank of each tooth, as shares of a tooth and of its depth.
    places, radii = np.array([0, 0.3, 0.42, 0.78, 0.9]), np.array([1, 1, 0, 0, 1]) * -depth + 1
    fine = max(round(triangles / (8 * 4 * teeth)), 1)
    share = np.append(np.arange(0, 4, 1 / fine), 4)
    place, radius = (np.interp(share, np.arange(5), v) for v in (places, radii))
    turn = (np.arange(teeth)[:, None] + place).ravel() * TAU / teeth
    rim = np.tile(radius, teeth)
    corners = [(rim * 0 + bore, 1), (rim * 0 + bore, -1), (rim, -1), (rim, 1)]
    points = [
        np.stack([r * np.cos(turn), r * np.sin(turn), np.full_like(turn, z * thick / 2)], axis=1)
        for r, z in corners
    ]
    return creased(tube(np.stack(points, axis=1)))


def sheet(rng: Rng, triangles: int) -> trimesh.Trimesh:
    """A thin plate, bent like a leaf and wavy."""
    n = max(round((triangles / 4) ** 0.5), 4)
    long = within(rng, 0.5, 1)
    thick = within(rng, 0.02, 0.06)
    mesh = box(np.linspace(-1, 1, n), np.linspace(-long, long, n), np.array([-thick, thick]) / 2)
    x, y, z = mesh.vertices.T
    roll = within(rng, -1.2, 1.2)
    wave = within(rng, 0, 0.12) * np.sin(within(rng, 2, 7) * x + within(rng, 2, 7) * y)
    mesh.vertices = np.stack([x, y, z + roll * x**2 / 2 + wave], axis=1)
    return creased(mesh)


KINDS: dict[str, Callable[[Rng, int], trimesh.Trimesh]] = {
    "torus": torus,
    "knot": knot,
    "capsule": capsule,
    "bowl": bowl,
    "rounded_box": rounded_box,
    "dented": dented,
    "gear": gear,
    "sheet": sheet,
}


def _grid(triangles: int, longer: float) -> tuple[np.ndarray, np.ndarray]:
    """Two angles over a grid (n, m) that makes so many triangles, n about m times `longer`."""
    m = max(round((triangles / 2 / longer) ** 0.5), 5)
    n = max(round(triangles / 2 / m), 8)
    angles = np.arange(n) * TAU / n, np.arange(m) * TAU / m
    return tuple(np.meshgrid(*angles, indexing="ij"))


def _turned(radius: np.ndarray, height: np.ndarray, triangles: int) -> trimesh.Trimesh:
    """A profile (n,) turned about z: from the axis below, round the outside, back to the axis."""
    profile = np.stack([np.where(radius < 1e-9, 0, radius), height], axis=1)
    sections = max(round(triangles / 2 / (len(profile) - 2)), 8)
    return trimesh.creation.revolve(profile, sections=sections)


def _ball(triangles: int) -> trimesh.Trimesh:
    """A unit sphere from a cube whose grid is even in angle."""
    grid = np.tan(np.linspace(-np.pi / 4, np.pi / 4, max(round((triangles / 12) ** 0.5), 2) + 1))
    mesh = box(grid, grid, grid)
    mesh.vertices = mesh.vertices / np.linalg.norm(mesh.vertices, axis=1, keepdims=True)
    return mesh
