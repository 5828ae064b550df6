"""What height-correlated masking, which Cycles has, adds to the light off a metal sphere.

    python -m reports.crosscheck.masking

Mitsuba's conductor and the paper's model take G = G1(wi) G1(wo); Cycles takes
1 / (1 + Lambda(wi) + Lambda(wo)) (Heitz 2014, eq. 99), which is never smaller. Nothing here is
Cycles' code: the gap is predicted from the formulas, to be laid beside the one that is measured.
"""

import numpy as np

from reports.stability.oracle import Lambda
from scenes.environment import load_environment
from scenes.mesh import placement
from scenes.schema import Case, Environment, Material
from scenes.suite import expand, load_suite

PIXELS, DIRECTIONS = 1024, 1024
BALL = "sphere"


def sphere_normals(case: Case, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Points spread evenly over the ball's disk in the picture: normals and directions to the eye.

    Both (count, 3), unit, in world space. Perspective is kept, the disk's ellipse is not.
    """
    obj = case.objects[case.index(BALL) - 1]
    matrix, eye = placement(obj), np.array(case.camera.origin)
    centre, radius = matrix[:3, 3], np.linalg.norm(matrix[:3, 0])
    axis = centre - eye
    distance = np.linalg.norm(axis)
    axis /= distance
    right = np.cross(axis, case.camera.up)
    right /= np.linalg.norm(right)
    number = np.arange(count) + 0.5
    turn = np.pi * (1 + 5**0.5) * number  # Vogel's spiral: equal areas
    across = np.sqrt(number / count) * radius / np.sqrt(distance**2 - radius**2)
    offsets = np.outer(np.cos(turn), right) + np.outer(np.sin(turn), np.cross(right, axis))
    rays = axis + across[:, None] * offsets
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    along = rays @ (centre - eye)
    reach = along - np.sqrt(np.maximum(along**2 - distance**2 + radius**2, 0))
    return (eye + reach[:, None] * rays - centre) / radius, -rays


def correlated_over_separable(
    material: Material, normals: np.ndarray, to_eye: np.ndarray, light: Environment | None
) -> float:
    """Light with height-correlated masking over that with separable masking, minus 1.

    Half vectors are drawn by D cos; both sums share them. Light that the sphere's neighbour
    blocks or returns is left out. `light` None is a white furnace.
    """
    rng = np.random.default_rng(0)
    frame = _frames(normals)
    wo = np.einsum("pij,pj->pi", frame, to_eye)[:, None]
    shape = (len(normals), DIRECTIONS)
    u = (np.arange(DIRECTIONS) + rng.random(shape)) / DIRECTIONS
    scaled = u / (1 - u) if material.weight == 1 else -np.log1p(-u)
    cos_h = 1 / np.sqrt(1 + material.alpha**2 * scaled)
    sin_h, turn = np.sqrt(1 - cos_h**2), 2 * np.pi * rng.random(shape)
    h = np.stack([sin_h * np.cos(turn), sin_h * np.sin(turn), cos_h], axis=-1)
    wo_h = (wo * h).sum(axis=-1)
    wi = 2 * wo_h[..., None] * h - wo
    seen = (wi[..., 2] > 0) & (wo_h > 0)
    pixel, _ = np.nonzero(seen)
    wi, wo_h, cos_h = wi[seen], wo_h[seen], cos_h[seen]
    wo = wo[pixel, 0]
    lam_i, lam_o = (Lambda(w, material.alpha, material.weight) for w in (wi, wo))
    arriving = np.ones_like(wi)
    if light is not None:
        arriving = radiance(light, np.einsum("pji,pj->pi", frame[pixel], wi))
    # f cos(wi) / pdf of a half vector drawn by D cos is F G (wo.h) / (cos_o cos_h).
    reflected = (conductor(wo_h, material) * arriving).mean(axis=1)
    weight = reflected * wo_h / (wo[:, 2] * cos_h)
    separable = (weight / (1 + lam_i) / (1 + lam_o)).sum()
    correlated = (weight / (1 + lam_i + lam_o)).sum()
    return float(correlated / separable - 1)


def _frames(normals: np.ndarray) -> np.ndarray:
    """World to local, (n, 3, 3), with the normal as the third row."""
    other = np.where(abs(normals[:, :1]) < 0.7, [1.0, 0, 0], [0, 1.0, 0])
    first = np.cross(other, normals)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return np.stack([first, np.cross(normals, first), normals], axis=1)


def conductor(cosine: np.ndarray, material: Material) -> np.ndarray:
    """Fresnel reflectance of a conductor in vacuum, (n, 3); Schlick where only F0 is known."""
    c = cosine[:, None]
    if material.metal.eta is None:
        f0 = np.array(material.metal.f0)
        return f0 + (1 - f0) * (1 - c) ** 5
    index = np.array(material.metal.eta) - 1j * np.array(material.metal.k)
    inside = np.sqrt(1 - (1 - c**2) / index**2)
    s = (c - index * inside) / (c + index * inside)
    p = (index * c - inside) / (index * c + inside)
    return (abs(s) ** 2 + abs(p) ** 2) / 2


def radiance(light: Environment, directions: np.ndarray) -> np.ndarray:
    """The nearest texel of the environment in world directions (n, 3)."""
    texels = load_environment(light.path).radiance
    rows, columns = texels.shape[:2]
    x, y, z = directions.T
    row = np.rint(np.arctan2(np.hypot(x, y), z) / np.pi * (rows - 1)).astype(int)
    column = (np.arctan2(x, y) / (2 * np.pi) + light.rotation / 360) * columns
    return texels[row, np.floor(column).astype(int) % columns]


def main() -> None:
    """Print the prediction for every metal of the suite, in its own light and in a furnace."""
    print(f"{'case':42} {'its light':>10} {'furnace':>10}")
    for entry in expand(*load_suite("crosscheck")):
        case = entry.case
        material = case.objects[case.index(BALL) - 1].material
        if material.metallic != 1:
            continue
        view = sphere_normals(case, PIXELS)
        own = correlated_over_separable(material, *view, case.environment)
        furnace = correlated_over_separable(material, *view, None)
        print(f"{case.id:42} {own:+10.2%} {furnace:+10.2%}")


if __name__ == "__main__":
    main()
