"""Three truths from one set of paths: what reaches the eye off the first surface that it sees.

At the first hit the light is split by what may reach the surface:

    unoccluded   the environment from everywhere, as if nothing stood in its way
    direct       the environment from where nothing stands in its way
    global       and what other surfaces send, traced on by Mitsuba's own `path`; under a sun with
                 caustics those are left out, to be traced from the lamps (reference.caustics)

Every estimate is one sample of the light and one of the BSDF, joined by the power heuristic
(Veach 1997, 9.2.4). Each truth also comes as the part that the diffuse lobe reflects.

Since all three share their paths, their differences hold only the noise of the light that differs.
The unoccluded light costs no ray, so it is estimated SPLIT times a path. Where most of the light
comes in freely, the better estimate serves the other two as a control variate (Owen 2013, 8.9):
X + c (U' - U), with U the unoccluded estimate of the path itself and U' the mean of the others. The
factor c is fixed beforehand for each pixel, so it cannot bias.
"""

from collections.abc import Callable
from functools import cache

import drjit as dr

from reference.caustics import Caustics, from_the_eye
from reference.sampling import diffuse_only, power_heuristic
from reference.settings import PATH, SPLIT
from reference.variant import mitsuba

mi = mitsuba()

Light = dict[str, mi.Color3f]
Parts = tuple[mi.Color3f, mi.Color3f]  # of the whole BSDF and of its diffuse lobe
Transport = Callable[[mi.Scene, mi.Sampler, mi.RayDifferential3f, mi.Float, Caustics | None], Light]


def model_light(
    scene: mi.Scene,
    sampler: mi.Sampler,
    ray: mi.RayDifferential3f,
    control: mi.Float,
    caustics: Caustics | None,
    alone: bool = False,
) -> Light:
    """Radiance along `ray` for every truth under the case's model.

    Args:
        control: the factor c, 0 to 1 - 1 / SPLIT.
        caustics: those that `global` leaves out.
        alone: nothing can occlude (reference.truths.nothing_occludes): all truths are one.

    Returns:
        Radiance by truth, and by "<truth>.diffuse" the part off the first hit's diffuse lobe.
    """
    truths = _first_hit(scene, sampler, ray, control, caustics, alone)
    parts = {f"{name}.diffuse": diffuse for name, (_, diffuse) in truths.items()}
    return {name: whole for name, (whole, _) in truths.items()} | parts


def physical_light(
    scene: mi.Scene,
    sampler: mi.Sampler,
    ray: mi.RayDifferential3f,
    control: mi.Float,
    caustics: Caustics | None,
    alone: bool = False,
) -> Light:
    """The same for Mitsuba's own materials: `physical` is their full transport."""
    whole, diffuse = _first_hit(scene, sampler, ray, control, caustics, alone)["global"]
    return {"physical": whole, "physical.diffuse": diffuse}


def _first_hit(
    scene: mi.Scene,
    sampler: mi.Sampler,
    ray: mi.RayDifferential3f,
    control: mi.Float,
    caustics: Caustics | None,
    alone: bool,
) -> dict[str, Parts]:
    """Radiance along `ray` by truth: all of it, and the part of the first hit's diffuse lobe."""
    si = scene.ray_intersect(ray)
    background = scene.environment().eval(si, ~si.is_valid())
    path = _Arrival(scene, sampler, si)
    others = [_Arrival(scene, sampler, si).unblocked() for _ in range(SPLIT - 1)]
    own = path.unblocked()
    if alone:  # no ray need be traced from the surface on
        mean = [sum(o[part] for o in (own, *others)) / SPLIT for part in range(2)]
        whole = background + mean[0], mean[1]
        return dict.fromkeys(("unoccluded", "direct", "global"), whole)
    inward = scene.ray_intersect_preliminary(path.onward, coherent=False, active=path.sampled)
    blocked = path.sampled & inward.is_valid()
    shadowed = scene.ray_test(path.to_light, path.lit)
    further = _further(scene, sampler, si, path, blocked, caustics)
    truths = {}
    for part in range(2):
        better = sum(other[part] for other in others) / (SPLIT - 1) - own[part]
        direct = (path.from_light[part] & ~shadowed) + (path.from_bsdf[part] & ~blocked)
        truths["unoccluded", part] = own[part] + (1 - 1 / SPLIT) * better
        truths["direct", part] = direct + control * better
        truths["global", part] = direct + further[part]
        truths["global", part] += control * better
    return {
        name: (background + truths[name, 0], truths[name, 1])
        for name in ("unoccluded", "direct", "global")
    }


def _further(
    scene: mi.Scene,
    sampler: mi.Sampler,
    si: mi.SurfaceInteraction3f,
    path: "_Arrival",
    blocked: mi.Bool,
    caustics: Caustics | None,
) -> Parts:
    """Other surfaces' light off the surface, without the caustics on its rough lobes."""
    if caustics is None:
        light = _path_tracer().sample(scene, sampler, path.onward, active=blocked)[0]
        return tuple(weight * light & blocked for weight in path.weights)
    plain, caustic = from_the_eye(scene, sampler, path.onward, blocked, caustics)
    whole, diffuse = path.weights
    smooth = caustics.from_smooth(si, whole, diffuse)
    return whole * plain + smooth * caustic & blocked, diffuse * plain & blocked


class _Arrival:
    """One sample of the environment's light and one of the BSDF at a hit.

    What comes in pairs is for the whole BSDF and for its diffuse lobe.

    Attributes:
        lit, to_light: whether the light's sample can be seen from the surface's side, and its ray.
        from_light: its radiance off the surface, as if nothing stood in its way.
        sampled, onward: whether the BSDF gave a direction, and the ray along it.
        weights: f cos / density of that direction.
        from_bsdf: the environment's radiance off the surface from there.
    """

    def __init__(self, scene: mi.Scene, sampler: mi.Sampler, si: mi.SurfaceInteraction3f) -> None:
        light, everything, diffuse = scene.environment(), mi.BSDFContext(), diffuse_only()
        hit, bsdf = si.is_valid(), si.bsdf()
        ds, radiance = light.sample_direction(si, sampler.next_2d(), hit)
        self.lit = hit & (ds.pdf > 0)
        wo = si.to_local(ds.d)
        f, density = bsdf.eval_pdf(everything, si, wo, self.lit)
        radiance = radiance * power_heuristic(ds.pdf, density) & self.lit
        self.from_light = f * radiance, bsdf.eval(diffuse, si, wo, self.lit) * radiance
        self.to_light = si.spawn_ray(ds.d)

        bs, weight = bsdf.sample(everything, si, sampler.next_1d(), sampler.next_2d(), hit)
        self.sampled = hit & (bs.pdf > 0)
        away, ds = dr.zeros(mi.SurfaceInteraction3f), dr.zeros(mi.DirectionSample3f)
        ds.d = si.to_world(bs.wo)
        away.wi = -ds.d
        heuristic = power_heuristic(bs.pdf, light.pdf_direction(si, ds, self.sampled))
        radiance = light.eval(away, self.sampled) * heuristic & self.sampled
        of_diffuse = bsdf.eval(diffuse, si, bs.wo, self.sampled) / bs.pdf
        self.weights = weight & self.sampled, of_diffuse & self.sampled
        self.from_bsdf = tuple(w * radiance for w in self.weights)
        self.onward = mi.RayDifferential3f(si.spawn_ray(ds.d))

    def unblocked(self) -> Parts:
        """The environment's radiance off the surface, as if nothing stood in its way."""
        return tuple(a + b for a, b in zip(self.from_light, self.from_bsdf, strict=True))


def unoccluded(scene: mi.Scene, sampler: mi.Sampler, ray: mi.RayDifferential3f) -> mi.Color3f:
    """The unoccluded radiance along `ray` by one estimate alone."""
    si = scene.ray_intersect(ray)
    background = scene.environment().eval(si, ~si.is_valid())
    return background + _Arrival(scene, sampler, si).unblocked()[0]


def openness(
    scene: mi.Scene,
    sampler: mi.Sampler,
    ray: mi.RayDifferential3f,
    _control: mi.Float,
    _caustics: Caustics | None,
) -> Light:
    """1 less the share of the BSDF's directions at the first hit in which something stands."""
    si = scene.ray_intersect(ray)
    sample = sampler.next_1d(), sampler.next_2d()
    bs, _ = si.bsdf().sample(mi.BSDFContext(), si, *sample, si.is_valid())
    active = si.is_valid() & (bs.pdf > 0)
    blocked = scene.ray_test(si.spawn_ray(si.to_world(bs.wo)), active)
    return {"openness": mi.Color3f(dr.select(active & blocked, mi.Float(0), 1))}


@cache
def _path_tracer() -> mi.SamplingIntegrator:
    return mi.load_dict(PATH)
