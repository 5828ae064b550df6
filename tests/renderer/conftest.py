"""Cases to draw, maps to light them, and integrals in double precision to judge by."""

import numpy as np
import OpenImageIO as oiio
import pytest

from renderer.context import context
from scenes.schema import Camera, Case, Environment, Material, Object


@pytest.fixture(autouse=True)
def _no_gl_error():
    """No test may begin or end with an OpenGL error."""
    assert context().error == "GL_NO_ERROR"
    yield
    assert context().error == "GL_NO_ERROR"


@pytest.fixture
def light(tmp_path):
    """Write a radiance map (H, W, 3), or one colour everywhere, and return its path."""
    made = []

    def write(radiance, size: tuple[int, int] = (16, 32)):
        pixels = np.ones((*size, 3)) * radiance if np.ndim(radiance) < 3 else radiance
        pixels = np.ascontiguousarray(pixels, np.float32)
        spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], 3, oiio.FLOAT)
        path = tmp_path / f"light{len(made)}.exr"
        made.append(path)
        image = oiio.ImageOutput.create(str(path))
        assert image.open(str(path), spec) and image.write_image(pixels) and image.close()
        return path

    return write


@pytest.fixture
def make_case():
    """A case from its light and objects (mesh, material, further fields of Object)."""

    def make(light, *objects, size=(64, 48), camera=None, rotation=0.0) -> Case:
        return Case(
            id="test",
            scene="test",
            environment=Environment(name="light", path=light, rotation=rotation),
            camera=camera or Camera(origin=(0, -4, 0), target=(0, 0, 0), fov=40),
            width=size[0],
            height=size[1],
            objects=tuple(
                Object(name=f"o{i}", mesh=mesh, material=material, **fields)
                for i, (mesh, material, fields) in enumerate(objects)
            ),
        )

    return make


@pytest.fixture
def copper():
    """Make copper of an alpha and a GGX share."""
    return lambda alpha, weight=1.0, **fields: Material(
        roughness=np.sqrt(alpha), metallic=1.0, metal="Cu", weight=weight, **fields
    )


@pytest.fixture
def rays():
    """The eye (3,) and the unit direction through every pixel's centre (H, W, 3) of a case."""

    def cast(case: Case) -> tuple[np.ndarray, np.ndarray]:
        camera = case.camera
        eye = np.array(camera.origin)
        forward = np.array(camera.target) - eye
        forward /= np.linalg.norm(forward)
        right = np.cross(forward, camera.up)
        right /= np.linalg.norm(right)
        up = np.cross(right, forward)
        half = np.tan(np.radians(camera.fov) / 2)
        aspect = case.width / case.height
        x = (2 * (np.arange(case.width) + 0.5) / case.width - 1) * half * aspect
        y = (1 - 2 * (np.arange(case.height) + 0.5) / case.height) * half
        d = forward + x[None, :, None] * right + y[:, None, None] * up
        return eye, d / np.linalg.norm(d, axis=2, keepdims=True)

    return cast


@pytest.fixture
def half_vectors():
    """Nodes h (n, 3) over the hemisphere, dense within alpha of n, and solid angles (n,)."""

    def nodes(alpha: float, polar: int, around: int) -> tuple[np.ndarray, np.ndarray]:
        x, weights = np.polynomial.legendre.leggauss(polar)
        s, ds = (x + 1) * np.pi / 4, weights * np.pi / 4
        theta = np.arctan(alpha * np.tan(s))
        stretch = alpha / np.cos(s) ** 2 / (1 + (alpha * np.tan(s)) ** 2)
        phi = (np.arange(around) + 0.5) * 2 * np.pi / around
        sin, cos = np.sin(theta)[:, None], np.cos(theta)[:, None]
        h = np.stack([sin * np.cos(phi), sin * np.sin(phi), cos + 0 * phi], axis=2)
        omega = np.sin(theta) * stretch * ds * 2 * np.pi / around
        return h.reshape(-1, 3), np.repeat(omega, around)

    return nodes


@pytest.fixture
def over_lobe(half_vectors):
    """Integrate f(wi, wo) cos over wi in double precision, through half vectors.

    Takes f as a function of (wi, wo), both (n, 3), that returns (n,) or (n, 3); wo is at cos_o.
    """

    def integrate(f, alpha: float, cos_o: float, polar: int = 400, around: int = 400):
        h, omega = half_vectors(alpha, polar, around)
        wo = np.array([np.sqrt(1 - cos_o**2), 0, cos_o])
        wo_h = h @ wo
        wi = 2 * wo_h[:, None] * h - wo
        seen = (wo_h > 0) & (wi[:, 2] > 0)
        wi, wo_h, omega = wi[seen], wo_h[seen], omega[seen]
        value = f(wi, np.broadcast_to(wo, wi.shape))
        return np.einsum("n,n...->...", omega * 4 * wo_h * wi[:, 2], value)

    return integrate
