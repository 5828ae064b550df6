"""Run one shader function over arrays of inputs: the real GLSL, for tests and checks."""

import math

import moderngl
import numpy as np

from renderer.context import context
from renderer.features import LOST_LIGHT, features
from renderer.glsl import source
from renderer.precompute.lost_light import lost_light
from renderer.program import bind_maps, compiled, fill, set_uniforms
from renderer.surface import surface_uniforms
from renderer.targets import release
from scenes.schema import PAPER, Material, Model

WIDTH = 1024


def probe(
    expression: str,
    inputs: dict[str, np.ndarray],
    includes: tuple[str, ...],
    defines: frozenset[str] = frozenset(),
    uniforms: dict | None = None,
    declarations: str = "",
    maps: dict[str, moderngl.Texture] | None = None,
) -> np.ndarray:
    """Evaluate a GLSL expression of type vec4 for every row of the inputs.

    Args:
        expression: GLSL; each input is in scope as a vec4 of its name, missing parts 0.
        inputs: (n,) or (n, 1..4) arrays, given to the shader as float32; one of a single row holds
            for all rows.
        includes: shader files that the expression needs.
        declarations: further GLSL before main, such as uniforms.
        maps: textures that the functions read, by the names of their samplers.

    Returns:
        (n, 4) float32.

    Raises:
        InputError: it does not compile.
    """
    gl = context()
    columns = {n: _padded(values) for n, values in inputs.items()}
    count = max(len(values) for values in columns.values())
    size = (min(count, WIDTH), math.ceil(count / WIDTH))
    fetches, declared, textures = [], [], {}
    for name, values in columns.items():
        if len(values) == 1:
            declared.append(f"uniform vec4 {name};")
            continue
        padded = np.zeros((size[0] * size[1], 4), np.float32)
        padded[:count] = values
        textures[f"input_{name}"] = gl.texture(size, 4, padded.tobytes(), dtype="f4")
        declared.append(f"uniform sampler2D input_{name};")
        fetches.append(f"vec4 {name} = texelFetch(input_{name}, ivec2(gl_FragCoord.xy), 0);")
    body = "\n".join(
        [
            *declared,
            declarations,
            "layout(location = 0) out vec4 probed;",
            f"void main() {{ {' '.join(fetches)} probed = {expression}; }}",
        ]
    )
    included = "\n".join(f'#include "{name}"' for name in includes)
    shader = compiled(
        source("fullscreen.vert"),
        source(f"{included}\n{body}", defines, inline=True),
        f"{expression} with {', '.join(includes)}",
    )
    set_uniforms(shader, **{n: tuple(v[0].tolist()) for n, v in columns.items() if len(v) == 1})
    set_uniforms(shader, **(uniforms or {}))
    bind_maps(shader, textures | (maps or {}))
    target = gl.texture(size, 4, dtype="f4")
    framebuffer = gl.framebuffer([target])
    gl.enable_only(0)
    fill(framebuffer, shader)
    values = np.frombuffer(target.read(), np.float32).reshape(-1, 4)[:count].copy()
    release(framebuffer, target, shader, *textures.values())
    return values


def _padded(values: np.ndarray) -> np.ndarray:
    """An input as rows of four numbers."""
    rows = np.asarray(values, np.float32)
    rows = rows.reshape(len(rows) if rows.ndim else 1, -1)
    return np.pad(rows, ((0, 0), (0, 4 - rows.shape[1])))


def brdf_values(
    material: Material, wi: np.ndarray, wo: np.ndarray, model: Model = PAPER
) -> np.ndarray:
    """The renderer's f(wi, wo) without the cosine, (n, 3), for unit directions (n, 3), n = +z.

    x is along the tangent, and maps count as 1.

    Raises:
        ValueError: the model needs an eta that the material does not have.
    """
    material = material.model_copy(update={"maps": type(material.maps)()})
    defines = features(material, model)
    uniforms, maps = surface_uniforms(material, model), {}
    if defines & LOST_LIGHT:
        lost = lost_light(material, model)
        uniforms["multiscatter"], maps["lost_light"] = lost.multiscatter, lost.texture
    if material.anisotropy != 0:
        defines, uniforms["alpha"] = defines | {"ANISOTROPIC"}, material.alphas
    return probe(
        "vec4(brdf(wi.xyz, wo.xyz, drawn_material()), 0.0)",
        {"wi": wi, "wo": wo},
        ("brdf.glsl", "drawn_material.glsl"),
        defines,
        uniforms,
        maps=maps,
    )[:, :3]
