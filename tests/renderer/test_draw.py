"""Whole frames: what lands where, and with what energy."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from scipy import ndimage

from reference.batches import render_batch
from renderer.draw import Renderer
from renderer.objects import object_ids, placed, vertex_array
from renderer.precompute import precomputed
from renderer.precompute.brdf_table import smith_table
from renderer.program import program, set_uniforms
from renderer.targets import make_target
from renderer.techniques import Technique, technique
from renderer.view import view
from reports.stability.oracle import oracle
from scenes.mesh import world_mesh
from scenes.schema import Camera, Material, Model

PLASTIC = Material(albedo=(0.6, 0.3, 0.05), roughness=0.6, metallic=0.0, weight=0.5)


def draw(name: str, case):
    return Renderer(technique(name), repeats=0).render(case)


@pytest.mark.parametrize("rotation", [0.0, 75.0, -170.0])
@pytest.mark.parametrize(("row", "column"), [(128, 100), (140, 511), (70, 0), (200, 300)])
def test_a_bright_texel_lands_where_a_projection_says(
    light, make_case, copper, row, column, rotation
):
    sun = np.zeros((256, 512, 3))
    sun[row, column] = 1.0
    theta, phi = row / 255 * np.pi, (column + 0.5) / 512 * 2 * np.pi - np.radians(rotation)
    to_sun = np.array([np.sin(phi) * np.sin(theta), np.cos(phi) * np.sin(theta), np.cos(theta)])
    aside = np.array([0.11, -0.07, 0.05])
    camera = Camera(origin=(1, 2, 3), target=tuple(np.array([1, 2, 3]) + to_sun + aside), fov=30)
    ball = ("sphere", copper(0.2), {"position": tuple(-9 * to_sun)})
    case = make_case(light(sun), ball, size=(200, 160), camera=camera, rotation=rotation)
    seen = draw("paper", case).rgb[..., 0].astype(float)

    forward = (to_sun + aside) / np.linalg.norm(to_sun + aside)
    right = np.cross(forward, [0, 0, 1])
    right /= np.linalg.norm(right)
    up, half = np.cross(right, forward), np.tan(np.radians(15))
    x = to_sun @ right / (to_sun @ forward) / half * 80 + 100
    y = 80 - to_sun @ up / (to_sun @ forward) / half * 80
    found_y, found_x = ndimage.center_of_mass(seen)
    # The tent of one texel, 7 pixels wide, on a sphere that the picture flattens.
    assert (found_x + 0.5, found_y + 0.5) == pytest.approx((x, y), abs=0.25)


def test_masks_agree_with_rays(light, make_case, copper, rays):
    ball = ("sphere", copper(0.2), {"position": (0.5, 0.0, 0.3), "scale": 0.8})
    floor = ("plane", PLASTIC, {"position": (0.0, 0.0, -0.4), "scale": 3.0})
    case = make_case(light(1.0), ball, floor, size=(160, 120))
    eye, d = rays(case)
    off = eye - [0.5, 0, 0.3]
    b = d @ off
    root = b**2 - (off @ off - 0.8**2)
    near = np.where(root > 0, -b - np.sqrt(np.maximum(root, 0)), np.inf)
    t = (-0.4 - eye[2]) / d[..., 2]
    hit = eye + t[..., None] * d
    t = np.where((t > 0) & (np.abs(hit[..., :2]) < 1.5).all(axis=2), t, np.inf)
    expected = np.where(np.minimum(near, t) == np.inf, 0, np.where(near < t, 1, 2))
    wrong = object_ids(case) != expected
    # The sphere's facets cut its circle by less than 1e-4 of its radius.
    assert wrong.sum() <= 3 and {1, 2} <= set(np.unique(expected))


def interior(case, steps: int = 2) -> np.ndarray:
    """Pixels whose neighbours show the same object."""
    ids = object_ids(case)
    size = 2 * steps + 1
    return ndimage.maximum_filter(ids, size) == ndimage.minimum_filter(ids, size)


def test_antialiasing_changes_nothing_away_from_edges(light, make_case, copper):
    sky = np.random.default_rng(0).uniform(0.5, 1.5, (16, 32, 3))
    case = make_case(light(sky), ("sphere", copper(0.3, 0.5), {}), size=(96, 96))
    smooth, hard = draw("paper", case).rgb, draw("paper-noaa", case).rgb
    inside, away = interior(case), object_ids(case) == 0
    # The ray through a pixel is interpolated in another target, and rounded there.
    np.testing.assert_allclose(smooth[inside & away], hard[inside & away], rtol=1e-5)
    # Where two facets share a pixel, each is shaded where it is seen.
    np.testing.assert_allclose(smooth[inside], hard[inside], rtol=0.02)
    assert (smooth != hard)[~inside].any()


@pytest.mark.parametrize("fraction", [0.0, 0.2, 0.4, 0.5, 0.7, 0.9])
def test_an_edge_is_box_filtered_coverage(light, make_case, fraction):
    black = Material(albedo=(0, 0, 0), roughness=1.0, metallic=0.0, f0=0.0)
    size, distance = 32, 4.0
    pixel = 2 * distance * np.tan(np.radians(20)) / size
    # The plane's right edge lies `fraction` into pixel column 20.
    edge = (20 + fraction - size / 2) * pixel
    place = {"position": (edge - 5, 0, 0), "rotate": (90, 0, 0), "scale": 10.0}
    case = make_case(light(1.0), ("plane", black, place), size=(size, size))
    row = draw("paper", case).rgb[size // 2, :, 0]
    dark = row[15]
    coverage = (row[20] - 1) / (dark - 1)
    assert coverage == pytest.approx(fraction, abs=1 / 8)  # four samples
    np.testing.assert_allclose(row[21:], 1, rtol=1e-6)


@pytest.mark.parametrize("roughness", [0.1, 0.3, 0.8])
def test_antialiasing_comes_close_to_64_times_the_pixels(light, make_case, copper, roughness):
    sky = np.random.default_rng(0).uniform(0.5, 1.5, (16, 32, 3))
    ball = ("sphere", copper(roughness, 0.5), {"position": (0.2, 0, 0.1), "scale": 0.7})
    behind = ("sphere", PLASTIC, {"position": (-0.4, 1.5, 0.4), "scale": 0.8})
    case = make_case(light(sky), ball, behind, size=(90, 70))
    many = replace(technique("paper"), supersample=8, msaa=0)
    truth = Renderer(many, repeats=0).render(case).rgb
    rim = ~interior(case, 1)
    off = {name: np.abs(draw(name, case).rgb / truth - 1) for name in ("paper", "paper-noaa")}
    assert off["paper"].mean() < 0.004
    assert off["paper"][rim].mean() < off["paper-noaa"][rim].mean() / 2


@pytest.mark.parametrize("name", ["paper", "paper-noaa", "sampled"])
@pytest.mark.parametrize("side", [1.0, 4.0])
def test_the_picture_does_not_depend_on_where_objects_may_be(
    monkeypatch, light, make_case, copper, name, side
):
    sky = np.random.default_rng(0).uniform(0.5, 1.5, (16, 32, 3))
    ball = ("sphere", copper(0.3, 0.5), {"position": (0.7, 0, 0.4), "scale": 0.3 * side})
    case = make_case(light(sky), ball, size=(90, 70))
    cropped = draw(name, case).rgb
    monkeypatch.setattr("renderer.draw.covered", lambda _objects, _camera, size: (0, 0, *size))
    np.testing.assert_allclose(draw(name, case).rgb, cropped, rtol=1e-4)


@pytest.mark.parametrize("name", ["paper", "paper-noaa", "sampled"])
def test_drawing_twice_gives_the_same_bytes(light, make_case, copper, name):
    sky = np.random.default_rng(0).uniform(0, 2, (16, 32, 3))
    objects = [("sphere", copper(0.1, 0.5), {}), ("plane", PLASTIC, {"position": (0, 0, -1)})]
    case = make_case(light(sky), *objects)
    first, second = draw(name, case), draw(name, case)
    assert first.rgb.tobytes() == second.rgb.tobytes()
    np.testing.assert_array_equal(first.ids, second.ids)
    assert np.isfinite(first.rgb).all() and first.rgb.min() >= 0


@pytest.mark.parametrize("alpha", [0.05, 0.36, 1.0])
@pytest.mark.parametrize(
    ("weight", "masking"), [(1.0, "paper"), (0.5, "paper"), (0.0, "paper"), (0.5, "smith")]
)
def test_sampled_in_constant_light_is_the_directional_albedo(
    light, make_case, rays, over_lobe, alpha, weight, masking
):
    material = PLASTIC.model_copy(update={"roughness": np.sqrt(alpha), "weight": weight})
    camera = Camera(origin=(0, -100, 0), target=(0, 0, 0), fov=1.2)
    case = make_case(light(2.0), ("sphere", material, {}), size=(16, 16), camera=camera)
    case = case.model_copy(update={"model": Model(masking=masking)})
    dense = Technique("dense", "shade_sampled.glsl", samples=4096, msaa=0)
    seen = Renderer(dense, repeats=0).render(case).rgb
    eye, d = rays(case)
    for row, column in [(8, 8), (8, 2), (12, 3)]:
        b = d[row, column] @ eye
        t = -b - np.sqrt(b**2 - (eye @ eye - 1))
        cos_o = -(eye + t * d[row, column]) @ d[row, column]
        albedo = over_lobe(lambda wi, wo: oracle(material, wi, wo, masking), alpha, cos_o, 200, 100)
        # 4,096 samples; facets tilt the normal by less than 1e-4.
        np.testing.assert_allclose(seen[row, column], 2 * albedo, rtol=0.004)


def test_every_coverage_sample_sees_the_whole_lobe(light, make_case):
    y, x = np.mgrid[:64, :128]
    sun = 1e5 * np.exp(-((y - 14) ** 2 + (x - 35) ** 2) / 20)
    gold = Material(roughness=0.3, metallic=1.0, metal="Au", weight=0.5)
    # Pixels so wide that their four normals see the sun each by another part of the lobe.
    case = make_case(light(1 + sun[..., None] * np.ones(3)), ("sphere", gold, {}), size=(24, 18))
    how = technique("sampled@4096")
    ours = Renderer(how, repeats=0).render(case).rgb.sum()
    theirs = Renderer(replace(how, supersample=8), repeats=0).render(case).rgb.sum()
    assert ours == pytest.approx(theirs, rel=0.02)  # what four normals a pixel miss


@pytest.mark.parametrize("weight", [1.0, 0.5, 0.25])
@pytest.mark.parametrize("albedo", [0.0, 0.6])
def test_few_directions_keep_the_energy_of_every_lobe(light, make_case, weight, albedo):
    material = Material(
        albedo=(albedo,) * 3, roughness=0.6, metallic=0.0, f0=0.3, weight=weight, weight_g=1.0
    )
    case = make_case(light(1.0), ("plane", material, {"rotate": (60, 0, 0), "scale": 9.0}))
    few, many = (draw(f"sampled@{n}", case).rgb.mean() for n in (4, 1024))
    # Four of them over 3,000 pixels: noise of one in a hundred is left.
    assert few == pytest.approx(many, rel=0.03)


@pytest.mark.parametrize("masking", ["paper", "smith"])
def test_the_paper_in_constant_light_is_the_directional_albedo_of_each_metal(
    light, make_case, copper, over_lobe, masking
):
    """The split sum is exact in constant light, and each object has its own masking."""
    alphas, weights = (0.36, 0.1), (0.5, 0.0)
    metals = [copper(a, w) for a, w in zip(alphas, weights, strict=True)]
    planes = [
        ("plane", m, {"position": (x, 0, 0), "scale": 2.0})
        for m, x in zip(metals, (-1, 1), strict=True)
    ]
    camera = Camera(origin=(0, -600, 300), target=(0, 0, 0), fov=0.2)
    case = make_case(light(2.0), *planes, size=(48, 48), camera=camera)
    frame = draw("paper", case.model_copy(update={"model": Model(masking=masking)}))
    cos_o = 300 / np.hypot(600, 300)
    for number, metal in enumerate(metals, start=1):
        inner = ndimage.binary_erosion(frame.ids == number, iterations=2)
        assert inner.sum() > 50
        albedo = over_lobe(
            lambda wi, wo, m=metal: oracle(m, wi, wo, masking), alphas[number - 1], cos_o
        )
        # As for the table: 1,024 samples.
        np.testing.assert_allclose(frame.rgb[inner].mean(axis=0), 2 * albedo, atol=0.01)


def test_a_model_that_cannot_be_drawn_is_refused(light, make_case, copper):
    case = make_case(light(1.0), ("sphere", copper(0.2), {}))
    with pytest.raises(ValueError, match="'paper' cannot draw fresnel = 'exact'"):
        draw("paper", case.model_copy(update={"model": Model(fresnel="exact")}))


def test_a_table_of_the_materials_own_counts_as_precomputation(light, make_case, copper):
    case = make_case(light(1.0), ("sphere", copper(0.21, 0.47), {}), size=(8, 8))
    smith = case.model_copy(update={"model": Model(masking="smith")})
    frame = draw("paper", smith)
    environment = precomputed(case.environment.path)
    shared = environment.cost(technique("paper").maps(case.objects[0].material, smith.model))
    table = smith_table(case.objects[0].material)
    assert frame.provenance["precomputation_seconds"] == shared + table.seconds > shared
    assert "table_ggx" not in environment.maps


@pytest.mark.parametrize("name", ["paper", "sampled@256"])
def test_weights_0_and_1_meet_the_mixture_in_its_limit(light, make_case, copper, name):
    sky = np.random.default_rng(0).uniform(0.5, 1.5, (16, 32, 3))
    lit = light(sky)
    for end, near in ((0.0, 1e-6), (1.0, 1 - 1e-6)):
        alone, mixed = (
            draw(name, make_case(lit, ("sphere", copper(0.2, w), {}), size=(48, 48))).rgb
            for w in (end, near)
        )
        if name == "paper":
            np.testing.assert_allclose(alone, mixed, rtol=1e-4)
        else:  # the mixture spends one sample of 256 on the lobe that does not count
            assert alone.mean() == pytest.approx(mixed.mean(), rel=1e-3)


def test_the_paper_is_linear_in_the_light(light, make_case, copper):
    sky = np.random.default_rng(0).uniform(0.5, 1.5, (16, 32, 3))
    once, thrice = (
        draw("paper", make_case(light(k * sky), ("sphere", copper(0.2, 0.5), {}))).rgb
        for k in (1, 3)
    )
    np.testing.assert_allclose(thrice, 3 * once, rtol=1e-5)


def test_stretched_normals_are_interpolated_as_unit_vectors(tmp_path, light, make_case, rays):
    corners = np.array([[-1.0, -0.7, 0], [1, -0.8, 0], [0.1, 0.9, 0]])
    normals = np.array([[-0.6, 0, 0.8], [0.6, 0, 0.8], [0, 0.6, 0.8]])
    mesh = trimesh.Trimesh(corners, [[0, 1, 2]], vertex_normals=normals, process=False)
    mesh.export(tmp_path / "leaf.ply", vertex_normal=True)
    camera = Camera(origin=(0, 0, 9), target=(0, 0, 0), up=(0, 1, 0), fov=30)
    leaf = (str(tmp_path / "leaf.ply"), PLASTIC, {"scale": (2.0, 1.0, 0.3)})
    case = make_case(light(1.0), leaf, camera=camera)
    stretched = world_mesh(case.objects[0])

    whole = (0, 0, case.width, case.height)
    target = make_target(whole[2:], 0, whole, whole)
    target.drawn.use()
    target.drawn.clear()
    shader = program("mesh.vert", "surface.frag")
    set_uniforms(shader, number=1, **placed(case.objects[0], view(case)))
    vertex_array(case.objects[0].mesh, shader).render()
    seen = np.frombuffer(target.drawn.read(components=4, dtype="f4"), np.float32)
    seen = seen.reshape(case.height, case.width, 4)[::-1, :, :3]
    target.release()

    eye, d = rays(case)
    at = eye + d * (-eye[2] / d[..., 2:])
    a, b, c = (stretched.vertices[v, :2].astype(float) for v in stretched.faces[0])
    u, v = np.linalg.solve(np.column_stack([b - a, c - a]), (at[..., :2] - a)[..., None])[..., 0].T
    u, v = u.T, v.T
    shares = np.stack([1 - u - v, u, v], axis=2)
    expected = shares @ stretched.normals[stretched.faces[0]].astype(float)
    expected /= np.linalg.norm(expected, axis=2, keepdims=True)
    inside = shares.min(axis=2) > 0.02
    assert inside.sum() > 250
    np.testing.assert_allclose(seen[inside], expected[inside], atol=1e-4)


def test_a_camera_inside_an_object_or_before_none_still_draws(light, make_case, copper):
    # The inner side of a closed mesh is black, as in Mitsuba.
    inside = draw("paper", make_case(light(1.0), ("sphere", copper(0.2), {"scale": 9.0})))
    assert (inside.rgb == 0).all() and (inside.ids == 1).all()
    behind = draw("paper", make_case(light(1.0), ("sphere", copper(0.2), {"position": (0, -9, 0)})))
    np.testing.assert_allclose(behind.rgb, 1, rtol=1e-6)
    assert (behind.ids == 0).all()


@pytest.mark.parametrize("unit", [1, 3e4, 1e-4])
@pytest.mark.parametrize("side", [6, 2e4, 2e5])
def test_masks_agree_with_the_reference_at_any_size(light, make_case, copper, unit, side):
    camera = Camera(origin=(0, -6 * unit, 1.4 * unit), target=(0, 0, unit / 2), fov=50)
    ball = ("sphere", copper(0.2), {"position": (0, 0, unit), "scale": unit})
    floor = ("plane", PLASTIC, {"scale": side * unit})
    case = make_case(light(1.0), ball, floor, size=(160, 120), camera=camera)
    expected = render_batch(case, "model", 1, 1).ids
    assert set(np.unique(expected)) == {0, 1, 2}
    # Grazed edges of triangles may fall to either side.
    assert (object_ids(case) != expected).mean() < 1e-3


def test_provenance_tells_the_device_and_times_apart(light, make_case, copper):
    frame = Renderer(technique("paper"), 3).render(
        make_case(light(1.0), ("sphere", copper(0.2), {}))
    )
    assert frame.provenance["technique"] == "paper" and frame.provenance["device"]
    assert len(frame.provenance["frame_seconds"]) == 3
    assert min(frame.provenance["frame_seconds"]) <= frame.seconds
