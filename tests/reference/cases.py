"""Materials for small cases, and a camera by hand."""

import numpy as np

from scenes.schema import Material


def metal(roughness=0.5, f0=1.0, **changes):
    """A metal given by its F0."""
    return Material(roughness=roughness, metallic=1, metal=f0, **changes)


def plastic(roughness=0.7, albedo=(0.5, 0.2, 0.1), **changes):
    """A dielectric."""
    fields = {"metallic": 0, "albedo": albedo} | changes
    return Material(roughness=roughness, **fields)


def project(camera, width, height, point):
    """Where a world point lands, in pixels from the upper left corner, by hand."""
    origin, target, up = (np.array(v, float) for v in (camera.origin, camera.target, camera.up))
    forward = (target - origin) / np.linalg.norm(target - origin)
    right = np.cross(forward, up) / np.linalg.norm(np.cross(forward, up))
    above = np.cross(right, forward)
    to = np.asarray(point, float) - origin
    scale = height / 2 / np.tan(np.radians(camera.fov) / 2) / (to @ forward)
    return width / 2 + scale * (to @ right), height / 2 - scale * (to @ above)
