"""Caustics: light of lamps that smooth surfaces throw on others, traced from the lamps.

A path  eye - x - .. - y - lamp  that leaves x by a rough lobe and meets the lamp by a smooth lobe
of y is found from the eye by chance only: seldom, and then it carries much. So 8 batches do not
know their own variance. Such paths alone are traced from the lamps instead (Arvo 1986) and joined
to the eye at x (Dutré et al. 1993), every other path from the eye as before: each path is counted
once (Veach 1997, 8.3 and 10.3).

A lamp is what the environment has over GLARE times its mean, texel by texel. A lobe is smooth if it
shows a lamp more than GLARE times as bright as a white diffuse surface would; at normal incidence
D / 4 against 1 / pi, which is 1 / (4 alpha²) for the GGX and the Beckmann lobe, 25 at alpha .1.
Below GLARE one path brings a pixel less than the 36 paths of its batch do together.
"""

from dataclasses import dataclass

import drjit as dr
import numpy as np

from reference.sampling import diffuse_only, power_heuristic
from reference.scene_dict import environment, shape_id
from reference.settings import PATH
from reference.variant import mitsuba
from scenes.environment import load_environment
from scenes.mesh import world_mesh
from scenes.schema import Case

mi = mitsuba()

GLARE = 25.0
UNIT = 2.0**-40  # of the environment's mean: light is summed in integers, the same in any order
LAMPS_SEED = 0x5EED1A3B  # sets the light paths' random numbers apart from the eye's


@dataclass(frozen=True, eq=False)
class Caustics:
    """What a case's caustics come from.

    Attributes:
        lamps: the part of the environment that counts as lamps.
        shapes: those with a smooth lobe.
        spheres: (n, 4) float32, a sphere around each of them: its centre and radius.
        mean: of the environment over all directions, linear radiance.
    """

    lamps: mi.Emitter
    shapes: mi.ShapePtr
    spheres: np.ndarray
    mean: float

    def smooth(self, shape: mi.ShapePtr) -> mi.Bool:
        """Whether a surface's specular lobe is smooth."""
        found = mi.Bool(False)
        for k in range(len(self.spheres)):
            found |= shape == dr.gather(mi.ShapePtr, self.shapes, mi.UInt32(k))
        return found

    def radiance(self, d: mi.Vector3f, active: mi.Bool) -> mi.Color3f:
        """Of the lamps from direction `d`."""
        si = dr.zeros(mi.SurfaceInteraction3f)
        si.wi = -d
        return self.lamps.eval(si, active)

    def from_smooth(
        self, si: mi.SurfaceInteraction3f, f: mi.Color3f, diffuse: mi.Color3f
    ) -> mi.Color3f:
        """The part of f that is a smooth lobe's, where `diffuse` is the diffuse lobe's."""
        return dr.select(self.smooth(si.shape), f - diffuse, 0)


def caustics(case: Case, scene: mi.Scene) -> Caustics | None:
    """The case's caustics, or nothing where none can be told from other light.

    It takes a smooth lobe, a rough one, and lamps that are worth the name: whose mean square over
    all directions is at least the square of the environment's mean, for below that, light found by
    chance is no noisier than a sky's.
    """
    smooth = [k for k, o in enumerate(case.objects) if 4 * GLARE * o.material.alpha**2 < 1]
    rough = len(smooth) < len(case.objects) or any(
        max(o.material.diffuse_albedo) > 0 for o in case.objects
    )
    radiance = load_environment(case.environment.path).radiance
    mean = _mean(radiance)
    lamps = np.maximum(radiance - np.float32(GLARE * mean), 0)
    if not smooth or not rough or _mean(lamps**2) < mean**2 or mean == 0:
        return None
    shapes = {shape.id(): shape for shape in scene.shapes()}
    pointers = mi.ShapePtr([shapes[shape_id(k)] for k in smooth])
    dr.make_opaque(pointers)
    spheres = np.stack([_sphere(world_mesh(case.objects[k]).vertices) for k in smooth])
    return Caustics(mi.load_dict(environment(case.environment, lamps)), pointers, spheres, mean)


def _mean(radiance: np.ndarray) -> float:
    """Over all directions and the channels; rows are aligned to the poles."""
    area = np.sin(np.linspace(0, np.pi, len(radiance)))
    return float(np.average(radiance.mean(axis=(1, 2), dtype=float), weights=area))


def _sphere(vertices: np.ndarray) -> np.ndarray:
    centre = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    return np.append(centre, np.linalg.norm(vertices - centre, axis=1).max()).astype(np.float32)


@dr.syntax
def from_the_eye(
    scene: mi.Scene, sampler: mi.Sampler, ray: mi.Ray3f, active: mi.Bool, caustics: Caustics
) -> tuple[mi.Color3f, mi.Color3f]:
    """What other surfaces send along `ray`, as Mitsuba's `path` finds it, told apart.

    Returns:
        Radiance without the lamps' light off a smooth lobe, and that light.
    """
    light, everything, diffuse = scene.environment(), mi.BSDFContext(), diffuse_only()
    plain, caustic = mi.Color3f(0), mi.Color3f(0)
    weight, of_smooth = mi.Color3f(1), mi.Color3f(0)
    ray, active, depth = mi.Ray3f(ray), mi.Bool(active), mi.UInt32(0)
    density = mi.Float(0)
    while dr.hint(active, exclude=[caustics]):
        si = scene.ray_intersect(ray, active)
        ds = dr.zeros(mi.DirectionSample3f)
        ds.d = ray.d
        away = active & ~si.is_valid()
        heuristic = power_heuristic(density, light.pdf_direction(si, ds, away))
        from_lamps = of_smooth * caustics.radiance(ray.d, away) * heuristic & away
        caustic += from_lamps
        plain += (weight * light.eval(si, away) * heuristic & away) - from_lamps

        active &= si.is_valid() & (depth + 1 < PATH["max_depth"])
        bsdf = si.bsdf()
        ds, radiance = light.sample_direction(si, sampler.next_2d(active), active)
        lit = active & (ds.pdf > 0)
        lit &= ~scene.ray_test(si.spawn_ray(ds.d), lit)
        wo = si.to_local(ds.d)
        f, density = bsdf.eval_pdf(everything, si, wo, lit)
        smooth = caustics.from_smooth(si, f, bsdf.eval(diffuse, si, wo, lit))
        heuristic = power_heuristic(ds.pdf, density)
        lamps = caustics.radiance(ds.d, lit) / ds.pdf
        from_lamps = weight * smooth * lamps * heuristic & lit
        caustic += from_lamps
        plain += (weight * f * radiance * heuristic & lit) - from_lamps

        bs, factor = bsdf.sample(
            everything, si, sampler.next_1d(active), sampler.next_2d(active), active
        )
        of_diffuse = bsdf.eval(diffuse, si, bs.wo, active) / bs.pdf
        active &= bs.pdf > 0
        of_smooth = weight * caustics.from_smooth(si, factor, of_diffuse)
        weight *= factor
        density = bs.pdf
        ray = si.spawn_ray(si.to_world(bs.wo))
        depth += 1
        chance = roulette(weight, depth)
        active &= sampler.next_1d(active) < chance
        weight /= chance
        of_smooth /= chance
    return plain, caustic


def from_the_lamps(
    caustics: Caustics, scene: mi.Scene, size: tuple[int, int], count: int, seed: int
) -> tuple[np.ndarray, np.ndarray]:
    """The caustics that reach the eye off a rough lobe, by `count` light paths.

    Args:
        size: height and width of the picture.

    Returns:
        Linear radiance, (H, W, 3) float64, and the part of it off the diffuse lobe.
    """
    sums = dr.zeros(mi.UInt64, 6 * size[0] * size[1])
    sampler = mi.load_dict({"type": "independent"})
    sampler.seed((seed + LAMPS_SEED) % 2**32, count)
    unit = UNIT * caustics.mean
    scale = mi.Float(size[0] * size[1] / count / unit)
    dr.make_opaque(scale)
    _throw(caustics, scene, sampler, sums, size[1], scale)
    pictures = sums.numpy().reshape(*size, 2, 3) * unit
    return pictures[:, :, 0], pictures[:, :, 1]


@dr.syntax
def _throw(
    caustics: Caustics,
    scene: mi.Scene,
    sampler: mi.Sampler,
    sums: mi.UInt64,
    width: int,
    scale: mi.Float,
) -> None:
    """Trace light paths, and add to `sums` what they bring to each pixel, times `scale`."""
    eye, everything, diffuse = scene.sensors()[0], mi.BSDFContext(), diffuse_only()
    ray, flux, active = _leaving(caustics, scene, sampler)
    flux *= scale
    weight, depth = mi.Color3f(1), mi.UInt32(1)
    while dr.hint(active, exclude=[caustics, sums]):
        si = scene.ray_intersect(ray, active)
        active &= si.is_valid()
        bsdf = si.bsdf()

        ds, importance = eye.sample_direction(si, mi.Point2f(0), active)
        seen = active & (ds.pdf > 0)
        seen &= ~scene.ray_test(si.spawn_ray_to(ds.p), seen)
        to_eye = si.to_local(ds.d)
        f = bsdf.eval(everything, si, to_eye, seen)
        off_diffuse = bsdf.eval(diffuse, si, to_eye, seen)
        rough = f - caustics.from_smooth(si, f, off_diffuse)
        arriving = flux * weight * importance * adjoint(si, to_eye)
        column = dr.minimum(mi.UInt32(ds.uv.x), width - 1)
        row = mi.UInt32(ds.uv.y)
        for part, lobe in enumerate((rough, off_diffuse)):
            for channel in range(3):
                place = 6 * (row * width + column) + (3 * part + channel)
                brought = mi.UInt64(arriving[channel] * lobe[channel])
                dr.scatter_add(sums, brought, place, seen)

        bs, factor = bsdf.sample(
            everything, si, sampler.next_1d(active), sampler.next_2d(active), active
        )
        weight *= factor * adjoint(si, bs.wo)
        ray = si.spawn_ray(si.to_world(bs.wo))
        depth += 1
        chance = roulette(weight, depth)
        active &= (bs.pdf > 0) & (depth < PATH["max_depth"]) & (sampler.next_1d(active) < chance)
        weight /= chance


def _leaving(
    caustics: Caustics, scene: mi.Scene, sampler: mi.Sampler
) -> tuple[mi.Ray3f, mi.Color3f, mi.Bool]:
    """Light of the lamps as it leaves a smooth lobe: rays, their flux, and whether there are any.

    Rays are aimed at the sphere around one of the shapes, all of them equally often, and count if
    they meet that shape first; so none counts twice.
    """
    shapes = len(caustics.spheres)
    aim = dr.minimum(mi.UInt32(sampler.next_1d() * shapes), shapes - 1)
    sphere = dr.gather(mi.Vector4f, mi.Float(caustics.spheres.ravel()), aim)
    ds, radiance = caustics.lamps.sample_direction(dr.zeros(mi.Interaction3f), sampler.next_2d())
    disc = mi.warp.square_to_uniform_disk_concentric(sampler.next_2d()) * sphere.w
    beside = mi.Frame3f(ds.d).to_world(mi.Vector3f(disc.x, disc.y, 0))
    far = dr.opaque(mi.Float, 2 * float(dr.norm(scene.bbox().extents())))
    si = scene.ray_intersect(mi.Ray3f(sphere.xyz + beside + ds.d * far, -ds.d))
    active = si.is_valid() & (si.shape == dr.gather(mi.ShapePtr, caustics.shapes, aim))

    glossy = mi.BSDFContext(mi.TransportMode.Importance)
    glossy.type_mask = +mi.BSDFFlags.Glossy
    bs, factor = si.bsdf().sample(glossy, si, sampler.next_1d(), sampler.next_2d(), active)
    flux = radiance * (shapes * dr.pi * dr.square(sphere.w)) * factor * adjoint(si, bs.wo)
    return si.spawn_ray(si.to_world(bs.wo)), flux, active & (bs.pdf > 0)


def adjoint(si: mi.SurfaceInteraction3f, to_eye: mi.Vector3f) -> mi.Float:
    """What f cos(to_eye) lacks where light comes along si.wi and normals are interpolated.

    Seen from the eye the cosines of shading are the light's, and those of geometry come with the
    solid angles (Veach 1997, 5.3.2).
    """
    light, eye = dr.dot(si.n, si.to_world(si.wi)), dr.dot(si.n, si.to_world(to_eye))
    below = light * to_eye.z
    return dr.select(below != 0, dr.abs(si.wi.z * eye / below), 0)


def roulette(weight: mi.Color3f, depth: mi.UInt32) -> mi.Float:
    """The chance that a path goes on, as Mitsuba's `path` has it."""
    chance = dr.minimum(dr.max(weight), 0.95)
    return dr.select(depth >= PATH["rr_depth"], chance, 1)
