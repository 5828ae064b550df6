"""Each hard case of a picture sees the fault that it is there for."""

import pytest

from renderer import glsl, precompute
from renderer.precompute import brdf_table
from renderer.program import program
from reports.run.stability.frames import measure
from reports.stability.hard import hard_cases

# Shader file, what stands there, what takes its place, the cases that must fail.
FAULTS = {
    "suns clipped to half floats": (
        "radiance.glsl",
        "return textureLod(radiance_map, radiance_uv(world), lod).rgb;",
        "return min(textureLod(radiance_map, radiance_uv(world), lod).rgb, 65504.0);",
        ("sun-1e+06", "sun-in-a-mirror"),
    ),
    "a seam that does not wrap": (
        "radiance.glsl",
        "return vec2(uv.x,",
        "return vec2(clamp(fract(uv.x), 0.5 / 32.0, 31.5 / 32.0),",
        ("bright-column-on-the-seam", "texel-1e6-seam"),
    ),
    "a pole that depends on the turn": (
        "latlong.glsl",
        "world.z) * INV_PI;",
        "world.z) * INV_PI + 0.02 * turn;",
        ("bright-poles",),
    ),
    "a turn of the wrong sign": (
        "latlong.glsl",
        "(0.5 * INV_PI) + turn",
        "(0.5 * INV_PI) - turn",
        ("everything-turned",),
    ),
    "an azimuth half a texel off": (
        "latlong.glsl",
        "(0.5 * INV_PI) + turn",
        "(0.5 * INV_PI) + turn + 0.5 / 32.0",
        ("mirrored-scene",),
    ),
    "rays half a pixel off": (
        "eye_ray.glsl",
        "picture_pixel() / picture_size",
        "(picture_pixel() + 0.5) / picture_size",
        ("mirrored-scene",),
    ),
    "light from nowhere": (
        "surface_shade.frag",
        "colour = vec4(L /",
        "colour = vec4((L + 1e-6) /",
        ("black", "camera-inside"),
    ),
    "light lost": ("reflected.glsl", "return shade(", "return 0.99 * shade(", ("furnace",)),
    "light that does not add up": (
        "reflected.glsl",
        "return shade(",
        "return 0.999 + 0.0 * shade(",
        ("light-doubled", "black"),
    ),
    "normals that are 0/0": (
        "surface.frag",
        "length2 > 0.0 ? world_normal * inversesqrt(length2) : vec3(0.0)",
        "normalize(world_normal)",
        ("normals-opposed",),
    ),
    "what faces away reflects": (
        "reflected.glsl",
        "if (dot(n, v) <= 0.0) return vec3(0.0);",
        "",
        ("normals-turned-away", "camera-inside"),
    ),
    "jitter by the framebuffer": (
        "shade_sampled.glsl",
        "uvec3(picture_pixel(), 1u)",
        "uvec3(gl_FragCoord.xy, 1u)",
        ("split-frame",),
    ),
    "a part that shows the corner": (
        "picture.glsl",
        "gl_FragCoord.xy + vec2(picture_corner)",
        "gl_FragCoord.xy",
        ("split-frame", "one-pixel-parts"),
    ),
    "a lobe with the other's weight": (
        "shade_paper.glsl",
        "m.weight_d.y * textureLod(prefiltered_beckmann",
        "m.weight_d.x * textureLod(prefiltered_beckmann",
        ("weight-1e-07-is-0", "weight-0.9999999-is-1"),
    ),
    "loops that end early": (
        "irradiance.frag",
        "y < cells.y;",
        "y < cells.y && y * cells.x < 16000;",
        ("constant-511x255",),
    ),
}


def forget() -> None:
    """Drop what was compiled or precomputed by other shaders."""
    program.cache_clear()
    precompute._cached.cache_clear()
    brdf_table._made.cache_clear()
    brdf_table._smith_table.cache_clear()


@pytest.fixture
def spoilt(monkeypatch):
    """Put a fault into a shader file."""
    read = glsl._read

    def spoil(file: str, right: str, wrong: str) -> None:
        assert read(file).count(right) == 1
        monkeypatch.setattr(
            glsl,
            "_read",
            lambda name: read(name).replace(right, wrong) if name == file else read(name),
        )
        forget()

    yield spoil
    monkeypatch.undo()
    forget()


@pytest.mark.long
@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_in_a_shader_fails_the_cases_that_are_there_for_it(tmp_path, spoilt, fault):
    file, right, wrong, names = FAULTS[fault]
    spoilt(file, right, wrong)
    for name in names:
        assert not measure(hard_cases()[name], tmp_path).passed
