"""The GLSL functions under test: how each is called, from what, and what it must return."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from reports.stability import fresnel, oracle

Inputs = dict[str, np.ndarray]  # (n, k) float32 by name

# How an input reaches the shader, and how many numbers a user gives for it.
DIRECTIONS = ("wi", "wo", "w", "h", "n")
PARTS = {
    **dict.fromkeys(DIRECTIONS, 3),
    **dict.fromkeys(("albedo", "f0", "f82", "count"), 3),
    **dict.fromkeys(("weight", "weight_g", "u"), 2),
    **dict.fromkeys(("alpha", "cosine", "tan", "eta", "k", "index", "points"), 1),
}
_SWIZZLE = {1: "x", 2: "xy", 3: "xyz"}


@dataclass(frozen=True)
class Function:
    """One GLSL function.

    Attributes:
        call: GLSL with its inputs' names in braces.
        includes: the shader files that it needs.
        inputs: their names, in the order of the call.
        exact: the same in double precision, from the inputs by name, (n,) or (n, k).
        parts: how many numbers it returns.
    """

    name: str
    call: str
    includes: tuple[str, ...]
    inputs: tuple[str, ...]
    exact: Callable[..., np.ndarray]
    parts: int = 1

    @property
    def glsl(self) -> str:
        """The call as an expression of type vec4."""
        names = {n: f"{n}.{_SWIZZLE[PARTS[n]]}" for n in self.inputs}
        return f"vec4({self.call.format(**names)}{', 0.0' * (4 - self.parts) * (self.parts > 1)})"

    def expected(self, inputs: Inputs, masking: str = "paper") -> np.ndarray:
        """What it must return, (n, parts), for the very float32 values of the inputs."""
        given = {}
        for name in self.inputs:
            value = np.asarray(inputs[name], np.float32).astype(float)
            scalar = PARTS[name] == 1
            # Weights come as a pair for all rows, as uniforms do.
            given[name] = value[:, 0] if scalar else tuple(value[0]) if "weight" in name else value
        if self.name in ("brdf", "G_mixture"):
            given["masking"] = masking
        with np.errstate(all="ignore"):
            return self.exact(**given).reshape(len(value), -1)


MATERIAL = "Material({albedo}, {f0}, {alpha}, {weight}, {weight_g})"


def _functions() -> list[Function]:
    ndf = ("h", "alpha")
    pair = ("wi", "wo", "alpha", "weight")
    return [
        Function("D_ggx", "D_ggx({h}, {alpha})", ("ndf_ggx.glsl",), ndf, oracle.D_ggx),
        Function(
            "D_beckmann", "D_beckmann({h}, {alpha})", ("ndf_beckmann.glsl",), ndf, oracle.D_beckmann
        ),
        Function(
            "D_mixture",
            "D_mixture({h}, {alpha}, {weight})",
            ("mixture.glsl",),
            (*ndf, "weight"),
            oracle.D_mixture,
        ),
        Function(
            "beckmann_over_ggx",
            "beckmann_over_ggx({h}, {alpha})",
            ("beckmann_over_ggx.glsl",),
            ndf,
            oracle.beckmann_over_ggx,
        ),
        Function(
            "G1_ggx",
            "G1_ggx({w}, {alpha})",
            ("masking_smith.glsl",),
            ("w", "alpha"),
            oracle.G1_smith,
        ),
        Function(
            "lambda_ggx",
            "1.0 + lambda_ggx({tan}, {alpha})",
            ("masking_smith_mixture.glsl",),
            ("tan", "alpha"),
            lambda tan, alpha: 1 + oracle.lambda_ggx(tan, alpha),
        ),
        Function(
            "lambda_beckmann",
            "1.0 + lambda_beckmann({tan}, {alpha})",
            ("masking_smith_mixture.glsl",),
            ("tan", "alpha"),
            lambda tan, alpha: 1 + oracle.lambda_beckmann(tan, alpha),
        ),
        Function(
            "G1_smith_mixture",
            "G1_smith_mixture({w}, {alpha}, {weight})",
            ("masking_smith_mixture.glsl",),
            ("w", "alpha", "weight"),
            oracle.G1_smith,
        ),
        Function(
            "G_smith",
            "G_smith({wi}, {wo}, {alpha})",
            ("masking_smith.glsl",),
            ("wi", "wo", "alpha"),
            lambda wi, wo, alpha: oracle.G1_smith(wi, alpha) * oracle.G1_smith(wo, alpha),
        ),
        Function(
            "G_vcavity",
            "G_vcavity({wi}, {wo}, normalize({wi} + {wo}), 0.5 * length({wi} + {wo}))",
            ("masking_vcavity.glsl",),
            ("wi", "wo"),
            oracle.G_vcavity,
        ),
        Function(
            "G_mixture",
            "G_mixture({wi}, {wo}, normalize({wi} + {wo}), 0.5 * length({wi} + {wo}), "
            "{alpha}, {weight})",
            ("mixture.glsl",),
            pair,
            oracle.G_mixture,
        ),
        Function(
            "F_schlick",
            "F_schlick({f0}, {cosine})",
            ("fresnel_schlick.glsl",),
            ("f0", "cosine"),
            oracle.F_schlick,
            3,
        ),
        *_fresnel(),
        Function(
            "brdf",
            f"brdf({{wi}}, {{wo}}, {MATERIAL})",
            ("brdf.glsl",),
            ("wi", "wo", "albedo", "f0", "alpha", "weight", "weight_g"),
            oracle.brdf,
            3,
        ),
        Function(
            "sample_density",
            "sample_density({wi}, {wo}, Material(vec3(1.0), vec3(1.0), {alpha}, vec2(0.5), "
            "vec2(0.5)), ivec3({count}))",
            ("shade_sampled.glsl",),
            ("wi", "wo", "alpha", "count"),
            oracle.sample_density,
        ),
        Function(
            "sample_visible_ggx",
            "sample_visible_ggx({u}, {wo}, {alpha})",
            ("sample_visible_ggx.glsl",),
            ("u", "wo", "alpha"),
            oracle.sampled_visible_ggx,
            3,
        ),
        Function(
            "pdf_visible_ggx",
            "pdf_visible_ggx(normalize({wi} + {wo}), {wo}, {alpha})",
            ("sample_visible_ggx.glsl",),
            ("wi", "wo", "alpha"),
            oracle.pdf_visible_ggx,
        ),
        Function(
            "filtered_density",
            "filtered_density({wi}, {wo}, Material(vec3(1.0), vec3(1.0), {alpha}, vec2(0.5), "
            "vec2(0.5)), ivec2({count}))",
            ("shade_filtered.glsl",),
            ("wi", "wo", "alpha", "count"),
            oracle.filtered_density,
        ),
        Function(
            "spiral",
            "spiral(int({index}), int({points}), 0, 1)",
            ("spiral.glsl",),
            ("index", "points"),
            oracle.spiral,
            2,
        ),
        Function(
            "view_frame",
            "view_frame({n}, {w})[0]",
            ("view_frame.glsl",),
            ("n", "w"),
            oracle.view_axis,
            3,
        ),
        *(
            Function(
                f"sample_{lobe}",
                f"sample_{lobe}({{u}}, {{alpha}})",
                (f"sample_{lobe}.glsl",),
                ("u", "alpha"),
                exact,
                3,
            )
            for lobe, exact in (
                ("ggx", oracle.sampled_ggx),
                ("beckmann", oracle.sampled_beckmann),
            )
        ),
        Function(
            "sample_cosine",
            "sample_cosine({u})",
            ("sample_cosine.glsl",),
            ("u",),
            oracle.sampled_cosine,
            3,
        ),
        Function(
            "tangent_frame", "tangent_frame({n})[0]", ("frame.glsl",), ("n",), oracle.tangent, 3
        ),
        Function(
            "latlong_from_direction",
            "latlong_from_direction({w}, 0.0)",
            ("latlong.glsl",),
            ("w",),
            oracle.latlong,
            2,
        ),
        Function(
            "hammersley",
            "hammersley(uint({index}), uint({points}))",
            ("hammersley.glsl",),
            ("index", "points"),
            oracle.hammersley,
            2,
        ),
    ]


def _fresnel() -> list[Function]:
    """F of the other models, and 1 - F, which has forms of its own."""
    both = []
    for name, inputs, parts, exact in (
        ("f82", ("f0", "f82"), 3, fresnel.F_f82),
        ("dielectric", ("eta",), 1, lambda eta, cosine: fresnel.F_exact(eta[:, None], 0, cosine)),
        (
            "conductor",
            ("eta", "k"),
            1,
            lambda eta, k, cosine: fresnel.F_exact(eta[:, None], k[:, None], cosine),
        ),
    ):
        given, file = (*inputs, "cosine"), (f"fresnel_{name}.glsl",)
        call = f"{name}({', '.join('{' + i + '}' for i in given)})"
        rest = (lambda f: lambda **values: 1 - f(**values))(exact)
        both.append(Function(f"F_{name}", f"F_{call}", file, given, exact, parts))
        both.append(
            Function(f"one_minus_F_{name}", f"one_minus_F_{call}", file, given, rest, parts)
        )
    return both


FUNCTIONS = {f.name: f for f in _functions()}
