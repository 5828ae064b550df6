"""What varies over an object's surface, as arrays that both renderers read."""

from dataclasses import dataclass

import numpy as np

from scenes.errors import InputError
from scenes.mesh import load_mesh
from scenes.schema import ALPHA_MIN, VERTEX, Material, Object
from scenes.tangents import world_tangents
from scenes.texture import load_texture


@dataclass(frozen=True, eq=False)
class Surface:
    """What an object's material reads besides numbers.

    Attributes:
        textures: by map, (H, W, k) float32, as `load_texture` gives them. They repeat, and are
            bilinear between texel centres, the first of which lies half a texel from 0.
        carried: by what the material needs of `uv`, `tangent` and the maps of vertices, (n, k)
            float32 at each vertex of the object's `world_mesh`.
    """

    textures: dict[str, np.ndarray]
    carried: dict[str, np.ndarray]


def surface(obj: Object) -> Surface:
    """Load what varies over an object; nothing for a material of numbers alone.

    Raises:
        InputError: a picture cannot be used, or the mesh lacks what a map needs.
    """
    maps, mesh = obj.material.maps, load_mesh(obj.mesh)
    textures = {name: load_texture(path, name) for name, path in maps.pictures.items()}
    needed = [name for name, value in maps.given.items() if value == VERTEX]
    needed += ["uv"] if textures else []
    carried = {}
    for name in needed:
        if name not in mesh.carried:
            problem, remedy = _lacking(name)
            raise InputError(obj.mesh, f"object '{obj.name}'", problem, remedy)
        carried[name] = mesh.carried[name]
        if name != "uv" and not ((carried[name] >= 0) & (carried[name] <= 1)).all():
            problem = f"its vertices' {name} leaves [0, 1]"
            raise InputError(obj.mesh, f"object '{obj.name}'", problem, "export it again, scaled")
    if "uv" in carried:
        carried["uv"] = np.float32(carried["uv"] * maps.repeat)
    if has_direction(obj.material):
        carried["tangent"] = world_tangents(obj)
    return Surface(textures, carried)


def has_direction(material: Material) -> bool:
    """Whether it needs tangents."""
    return material.anisotropy != 0 or "normal" in material.maps.given


def _lacking(name: str) -> tuple[str, str]:
    if name == "uv":
        return "the mesh has no texture coordinates", "unwrap it, or map by 'vertex'"
    if name == "albedo":
        return "its vertices carry no colour", "export red, green, blue (PLY) or COLOR_0 (GLB)"
    given = f"export the property {name} (PLY) or the attribute _{name.upper()} (GLB)"
    return f"its vertices carry no {name}", given


def plain(obj: Object) -> Material:
    """The object's material with the mean of each map in place of the map, and no direction.

    Roughness is averaged as alpha², the variance of slopes.
    """
    material = obj.material
    if not material.varies:
        return material
    found = surface(obj)
    values = found.textures | found.carried

    def mean(name: str, power: int = 1) -> np.ndarray:
        held = (
            values[name].reshape(-1, values[name].shape[-1]) if name in values else np.ones((1, 1))
        )
        return np.mean(held.astype(float) ** power, axis=0) ** (1 / power)

    return material.model_copy(
        update={
            "albedo": tuple((np.array(material.albedo) * mean("albedo")).tolist()),
            "roughness": float(material.roughness * mean("roughness", 4)[0]),
            "metallic": float(material.metallic * mean("metallic")[0]),
            "weight": float(material.weight * mean("weight")[0]),
            "anisotropy": 0.0,
            "maps": type(material.maps)(),
        }
    )


def finest_alpha(obj: Object) -> float:
    """The least width of the lobe anywhere and along any direction."""
    found = surface(obj)
    held = (found.textures | found.carried).get("roughness", np.ones(1))
    alpha = (obj.material.roughness * float(held.min())) ** 2
    return max(alpha * min(obj.material.stretch), ALPHA_MIN)
