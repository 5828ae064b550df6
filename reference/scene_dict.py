"""A case as a Mitsuba scene: the same arrays and numbers that the other renderer reads."""

import drjit as dr
import numpy as np

import reference.mixture
import reference.varying  # noqa: F401  registers the plugin `varying`
from reference.physical import eta_notes, named_metal, one_eta, physical_bsdf, plastic
from reference.variant import mitsuba
from scenes.environment import load_environment
from scenes.errors import InputError
from scenes.mesh import Mesh, world_mesh
from scenes.schema import VERTEX, Camera, Case, Environment, Model, Object
from scenes.surface import Surface, has_direction, surface

mi = mitsuba()


def build_scene(case: Case, physical: bool = False) -> tuple[mi.Scene, list[str]]:
    """The case as a scene, and what could not be matched in its materials.

    Args:
        physical: Mitsuba's own plugins for the materials instead of the case's model.

    Raises:
        InputError: a mesh, an environment or a material cannot be used.
    """
    notes: list[str] = []
    placed = [world_mesh(obj) for obj in case.objects]
    radiance = load_environment(case.environment.path).radiance
    scene = {
        "type": "scene",
        "sensor": sensor(case.camera, case.width, case.height, _reach(case.camera, placed)),
        "environment": environment(case.environment, radiance),
    }
    for number, obj in enumerate(case.objects):
        if physical:
            bsdf, remarks = physical_bsdf(obj)
        else:
            bsdf, remarks = model_bsdf(obj, case.model)
        notes += remarks
        name, carried = shape_id(number), dict(surface(obj).carried)
        if physical and obj.material.anisotropy:  # stock plugins find the direction of u themselves
            carried["uv"] = placed[number].carried["uv"]
        scene[name] = mesh(placed[number], bsdf, name, carried)
    # Without `optimize`, shapes stay as they are, one per object, and can be told apart.
    return mi.load_dict(scene, optimize=False), notes


def shape_id(number: int) -> str:
    """The id of the shape of case.objects[number]."""
    return f"object_{number:03}"


def model_bsdf(obj: Object, model: Model) -> tuple[dict, list[str]]:
    """The object's material under the case's model, with notes on what could not be matched.

    Raises:
        InputError: the model needs eta and k of a material that is given by its F0 alone.
    """
    material = obj.material
    if material.varies:
        return _varying(obj, model)
    bsdf = {
        "type": "mixture",
        **model.model_dump(),
        "albedo": list(material.diffuse_albedo),
        "alpha": material.alpha,
        "weight": material.weight,
        "weight_g": material.masking_weight,
    }
    if model.fresnel != "exact":
        bsdf["f0"] = list(material.specular_f0)
        return bsdf | ({"f82": list(material.specular_f82)} if model.fresnel == "f82" else {}), []
    bsdf["metallic"] = material.metallic
    if material.metallic > 0:
        metal = named_metal(obj)
        bsdf |= {"metal_eta": list(metal.eta), "metal_k": list(metal.k)}
    if material.metallic < 1:
        bsdf["eta"] = one_eta(obj)
    if model.kd == "interface" and max(material.diffuse_albedo) > 0:
        used = {"ggx": material.weight > 0, "beckmann": material.weight < 1}
        bsdf |= {f"layer_{name}": plastic(material, name) for name in used if used[name]}
    return bsdf, eta_notes(obj)


def _varying(obj: Object, model: Model) -> tuple[dict, list[str]]:
    """The same for a material with a direction or with maps.

    Raises:
        InputError: too, the model needs a table or a layer that knows but one width.
    """
    material, found = obj.material, surface(obj)
    partly = material.metallic < 1 or material.maps.metallic is not None
    lit = partly and max(material.albedo) > 0
    if model.multiscatter != "off" or (model.kd != "one-minus-fresnel" and lit):
        problem = "anisotropy and maps go with kd = 'one-minus-fresnel' and multiscatter = 'off'"
        raise InputError(f"object '{obj.name}'", "material", problem, "change the model")
    along, across = material.stretch
    bsdf = {
        "type": "varying",
        **model.model_dump(include={"fresnel", "kd", "masking"}),
        "albedo": list(material.albedo) if lit else [0, 0, 0],
        "alpha": material.alpha,
        "roughness": material.roughness,
        "stretch_x": along,
        "stretch_y": across,
        "rotation": float(np.radians(material.rotation)),
        "directed": has_direction(material),
        "follows": material.weight_g is None,
        "weight": material.weight,
        "weight_g": material.masking_weight,
        "metallic": material.metallic,
        **_textures(obj, found),
    }
    if model.fresnel != "exact":
        parts = {"": 0.0, "metal_": 1.0 if material.metal else 0.0}
        for prefix, metallic in parts.items():
            part = material.model_copy(update={"metallic": metallic})
            bsdf[f"{prefix}f0"] = list(part.specular_f0)
            if model.fresnel == "f82":
                bsdf[f"{prefix}f82"] = list(part.specular_f82)
        return bsdf, []
    if material.metallic > 0:
        metal = named_metal(obj)
        bsdf |= {"metal_eta": list(metal.eta), "metal_k": list(metal.k)}
    if partly:
        bsdf["eta"] = one_eta(obj)
    return bsdf, eta_notes(obj)


def _textures(obj: Object, found: Surface) -> dict[str, dict]:
    """A material's maps as textures: pictures are bilinear and repeat."""
    textures = {}
    for name, value in obj.material.maps.given.items():
        if value == VERTEX:
            textures[f"{name}_map"] = {"type": "mesh_attribute", "name": f"vertex_{name}"}
            continue
        texels = found.textures[name]
        if name == "normal":  # Mitsuba knows no texture of two channels
            texels = np.concatenate([texels, 0 * texels[..., :1]], axis=2)
        textures[f"{name}_map"] = {
            "type": "bitmap",
            "bitmap": mi.Bitmap(np.ascontiguousarray(texels)),
            "raw": True,
        }
    return textures


def mesh(source: Mesh, bsdf: dict, name: str, carried: dict[str, np.ndarray]) -> mi.Mesh:
    """Triangles in world space, with the given normal at each vertex, and what else it carries."""
    props = mi.Properties()
    props["bsdf"] = mi.load_dict(bsdf)
    shape = mi.Mesh(
        name,
        len(source.vertices),
        len(source.faces),
        props=props,
        has_vertex_normals=True,
        has_vertex_texcoords="uv" in carried,
    )
    for which, values in carried.items():
        if which == "tangent":
            shape.add_attribute("vertex_tangent", 3, values[:, :3].ravel())
            shape.add_attribute("vertex_side", 1, values[:, 3].ravel())
        elif which != "uv":
            shape.add_attribute(f"vertex_{which}", values.shape[1], values.ravel())
    params = mi.traverse(shape)
    if "uv" in carried:
        params["vertex_texcoords"] = carried["uv"].ravel()
    params["vertex_positions"] = source.vertices.ravel()
    params["vertex_normals"] = source.normals.ravel()
    params["faces"] = source.faces.ravel()
    params.update()
    shape.set_id(name)
    return shape


def environment(source: Environment, radiance: np.ndarray) -> dict:
    """A radiance map as an `envmap`, turned as `source` is, in a world that is z-up.

    Mitsuba's column u lies at atan2(x, -z) = 2 pi u of local space and its rows run along y; ours
    at atan2(x, y) = 2 pi (u - rotation / 360) and along z.
    """
    lit = bool(radiance.any())
    upright = mi.ScalarTransform4f().rotate([1, 0, 0], 90)
    return {
        "type": "envmap",
        # Directions are drawn by brightness, which for a black map is 0/0.
        "bitmap": mi.Bitmap(np.ascontiguousarray(radiance if lit else np.ones_like(radiance))),
        "scale": float(lit),
        "to_world": mi.ScalarTransform4f().rotate([0, 0, 1], source.rotation) @ upright,
    }


def _reach(camera: Camera, placed: list[Mesh]) -> float:
    """A distance from the eye within which everything lies."""
    eye = np.array(camera.origin)
    corners = [(m.vertices.min(axis=0), m.vertices.max(axis=0)) for m in placed]
    return max(
        float(np.linalg.norm(np.maximum(abs(low - eye), abs(high - eye)))) for low, high in corners
    )


def sensor(camera: Camera, width: int, height: int, reach: float) -> dict:
    """A pinhole of vertical field of view, with a box filter over each pixel.

    Its clip distances only bound the rays, so they lie well outside of what can be seen.
    """
    look = mi.ScalarTransform4f().look_at(
        origin=list(camera.origin), target=list(camera.target), up=list(camera.up)
    )
    return {
        "type": "perspective",
        "fov_axis": "y",
        "fov": camera.fov,
        "near_clip": 2e-7 * reach,
        "far_clip": 2 * reach,
        "to_world": look,
        "film": {
            "type": "hdrfilm",
            "width": width,
            "height": height,
            "rfilter": {"type": "box"},
            "component_format": "float32",
            "pixel_format": "rgb",
        },
    }


def camera_rays(scene: mi.Scene, case: Case, position: mi.Point2f) -> mi.RayDifferential3f:
    """Rays through film positions in pixels, (0, 0) at the upper left corner of the picture."""
    fraction = position / mi.ScalarPoint2f(case.width, case.height)
    zero = dr.zeros(mi.Float, dr.width(position))
    return scene.sensors()[0].sample_ray_differential(zero, zero, fraction, mi.Point2f(0.5))[0]
