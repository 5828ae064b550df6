"""How frame time, precomputation and memory grow with what a scene holds, one size at a time."""

import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np
import OpenImageIO as oiio
import trimesh

from renderer.context import context
from renderer.draw import Renderer
from renderer.passes import Prepared, draw_frame
from renderer.precompute import Precomputed, precomputed
from renderer.techniques import Technique, technique
from reports.progress import Reporter
from reports.run.bench.memory import growing
from reports.speed.growth import grows
from reports.speed.points import Growth
from scenes.environment import load_environment
from scenes.mesh import load_mesh
from scenes.schema import Camera, Case, Environment, Material, Object
from scenes.suite import HERE

FRAMES, FEWER = 9, 3  # timed of each size; the fewer where one takes over a second
SLOW = 1.0
BUNNY = str(HERE / "meshes" / "bunny.ply")
SHELF = HERE / "environments" / "courtyard.exr"
ROW = 4  # objects in a row of the scene over which the number of materials grows


@dataclass(frozen=True)
class Sizes:
    """What is drawn: each axis grows alone, the others stay at their smallest but `picture`.

    Attributes:
        heights: of 16:9 pictures, pixels; those over `sampled_up_to` are too slow to sample.
        subdivisions: of an icosahedron, each four times the triangles.
        materials: different ones, dealt out to ROW² objects that are always the same.
        samples: directions per pixel; below 4 each coverage sample would still take one.
        maps: heights of the environment in texels, resampled from a shipped one.
        picture: the height of the picture where that does not grow.
    """

    heights: tuple[int, ...] = (135, 270, 540, 720, 1080, 1440, 2160)
    sampled_up_to: int = 1080
    subdivisions: tuple[int, ...] = (4, 5, 6, 7, 8)
    materials: tuple[int, ...] = (1, 2, 4, 8, 16)
    samples: tuple[int, ...] = (4, 8, 16, 32, 64, 128)
    maps: tuple[int, ...] = (128, 256, 512, 1024, 2048)
    picture: int = 270


@dataclass(frozen=True)
class Costs:
    """What one size took: seconds of a warm frame, frames timed, seconds once, bytes."""

    frame: float
    frames: int
    precomputation: float
    memory: float


SIZES = Sizes()
STEPS = 5  # that `grown` reports


def grown(report: Reporter, sizes: Sizes = SIZES) -> list[Growth]:
    """Every cost over every size, in STEPS steps.

    Call it last: meshes of a million triangles stay with OpenGL until the process ends.
    """
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        made = [
            *_over_pixels(report, sizes),
            *_over_triangles(report, sizes, work),
            *_over_materials(report, sizes, work),
            *_over_samples(report, sizes),
            *_over_environment(report, sizes, work),
        ]
    load_environment.cache_clear()  # the files that they held are gone
    load_mesh.cache_clear()
    return made


def _over_pixels(report: Reporter, sizes: Sizes) -> Iterator[Growth]:
    report.step("how costs grow with pixels")
    for name in ("paper", "paper-noaa", "sampled@16"):
        sampled = technique(name).samples > 0
        heights = [h for h in sizes.heights if not sampled or h <= sizes.sampled_up_to]
        cases = [_case([_object()], h) for h in heights]
        pixels = [float(c.width * c.height) for c in cases]
        costs = _costs(cases, [technique(name)] * len(cases))
        yield _growth("pixels", name, "frame", pixels, costs)
        yield _growth("pixels", name, "memory", pixels, costs)


def _over_triangles(report: Reporter, sizes: Sizes, work: Path) -> Iterator[Growth]:
    report.step("how costs grow with triangles")
    meshes = [_ball(n, work) for n in sizes.subdivisions]
    cases = [_case([_object(mesh)], sizes.picture) for mesh in meshes]
    triangles = [float(len(load_mesh(mesh).faces)) for mesh in meshes]
    for name in ("paper", "paper-noaa", "sampled@16"):
        costs = _costs(cases, [technique(name)] * len(cases))
        yield _growth("triangles", name, "frame", triangles, costs)
        if name == "paper":  # the buffers that it makes serve the others too
            yield _growth("triangles", name, "memory", triangles, costs)


def _over_materials(report: Reporter, sizes: Sizes, work: Path) -> Iterator[Growth]:
    report.step("how costs grow with materials")
    ball = _ball(min(sizes.subdivisions), work)
    cases = [_case(_row(ball, count), sizes.picture) for count in sizes.materials]
    for name in ("paper", "paper-noaa", "sampled@16"):
        costs = _costs(cases, [technique(name)] * len(cases))
        yield _growth("materials", name, "frame", [float(n) for n in sizes.materials], costs)


def _over_samples(report: Reporter, sizes: Sizes) -> Iterator[Growth]:
    report.step("how costs grow with samples")
    case = _case([_object()], sizes.picture)
    techniques = [technique(f"sampled@{n}") for n in sizes.samples]
    costs = _costs([case] * len(techniques), techniques)
    yield _growth("samples", "sampled@N", "frame", [float(n) for n in sizes.samples], costs)


def _over_environment(report: Reporter, sizes: Sizes, work: Path) -> Iterator[Growth]:
    report.step("how costs grow with the environment's size")
    paths = [_resampled(height, work) for height in sizes.maps]
    cases = [_case([_object()], sizes.picture, path) for path in paths]
    texels = [float(2 * height**2) for height in sizes.maps]
    for name in ("paper", "sampled@16"):
        costs = _costs(cases, [technique(name)] * len(cases), precompute=True)
        for cost in ("frame", "precomputation", "memory"):
            yield _growth("environment", name, cost, texels, costs)


def _growth(over: str, name: str, cost: str, sizes: list[float], costs: list[Costs]) -> Growth:
    values = [getattr(c, cost) for c in costs]
    exponent, base = grows(sizes, values)
    frames = [c.frames if cost == "frame" else 1 for c in costs]
    return Growth(
        over=over,
        technique=name,
        cost=cost,
        sizes=sizes,
        values=values,
        frames=frames,
        exponent=exponent,
        base=base,
    )


def _costs(
    cases: Sequence[Case], techniques: Sequence[Technique], precompute: bool = False
) -> list[Costs]:
    """What each size costs, after a first one that is drawn to compile and is not counted."""
    pairs = list(zip(cases, techniques, strict=True))
    return [_cost(case, how, precompute) for case, how in (pairs[0], *pairs)][1:]


def _cost(case: Case, how: Technique, precompute: bool) -> Costs:
    """One size: what it takes from decoded files to the first frame, then warm frames.

    Args:
        precompute: make the environment's maps anew, else they are there before.
    """
    path = case.environment.path
    load_environment(path)
    for obj in case.objects:
        load_mesh(obj.mesh)
    maps = sorted({m for o in case.objects for m in how.maps(o.material, case.model)})
    if not precompute:
        precomputed(path).need(maps)
    with growing() as growth:
        start = perf_counter()
        environment = Precomputed(path) if precompute else precomputed(path)
        environment.need(maps)
        context().finish()
        precomputation = perf_counter() - start
        prepared = Renderer(how).prepare(case, environment.maps)
        draw_frame(prepared)
    times = [_seconds(prepared)]
    while len(times) < (FEWER if times[0] > SLOW else FRAMES):
        times.append(_seconds(prepared))
    prepared.target.release()
    return Costs(median(times), len(times), precomputation, growth.peak)


def _seconds(prepared: Prepared) -> float:
    """Of one warm frame."""
    start = perf_counter()
    draw_frame(prepared)
    return perf_counter() - start


def _case(objects: list[Object], height: int, path: Path = SHELF) -> Case:
    """Objects around the origin, all in the picture."""
    spread = max(abs(o.position[0]) for o in objects)
    return Case(
        id="growth",
        scene="growth",
        environment=Environment(name=path.stem, path=path),
        camera=Camera(origin=(0, -4 - 7 * spread, 0.5), target=(0, 0, 0.5), fov=18),
        width=height * 16 // 9,
        height=height,
        objects=objects,
    )


def _object(mesh: str = BUNNY, name: str = "object", number: int = 0, **where: Any) -> Object:
    """One object of height 1; `number` chooses its material.

    Materials run through all lobes, and no two of ROW² are alike: half metal over roughness, and
    over GGX alone, Beckmann alone and mixtures.
    """
    material = Material(
        albedo=(0.6, 0.3, 0.1),
        roughness=0.3 + 0.5 * number / ROW**2,
        metallic=0.5,
        metal="Cu",
        weight=(0.5, 1.0, 0.0, 0.25)[number % 4],
    )
    return Object(name=name, mesh=mesh, material=material, height=1.0, **where)


def _row(mesh: str, count: int) -> list[Object]:
    """ROW² objects on a grid that share so many materials."""
    middle = (ROW - 1) / 2
    places = [(1.2 * (k % ROW - middle), 0, 1.2 * (k // ROW - middle)) for k in range(ROW**2)]
    return [_object(mesh, f"{k}", k % count, position=place) for k, place in enumerate(places)]


def _ball(subdivisions: int, work: Path) -> str:
    """A sphere of 20 * 4^n triangles with its normals, as a file."""
    path = work / f"ball{subdivisions}.ply"
    if not path.exists():
        ball = trimesh.creation.icosphere(subdivisions=subdivisions)
        ball.vertex_normals = ball.vertices
        ball.export(path, vertex_normal=True)
    return str(path)


def _resampled(height: int, work: Path) -> Path:
    """A shipped environment at another size, as a file."""
    path = work / f"map{height}.exr"
    pixels = oiio.ImageBuf(np.ascontiguousarray(load_environment(SHELF).radiance))
    small = oiio.ImageBufAlgo.resample(pixels, roi=oiio.ROI(0, 2 * height, 0, height, 0, 1, 0, 3))
    small.write(str(path), oiio.FLOAT)
    return path
