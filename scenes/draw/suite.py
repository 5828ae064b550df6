"""A suite of cases drawn at random, as ordinary files."""

from pathlib import Path
from typing import Any

import tomlkit

from scenes.draw.cameras import ENOUGH, draw_camera
from scenes.draw.dice import dealt, stream, within
from scenes.draw.environments import KINDS as ENVIRONMENTS
from scenes.draw.environments import draw_environment
from scenes.draw.layout import GROUNDED, SETTINGS, Body, Plane, arranged, pose, standing
from scenes.draw.materials import draw_material, draw_paint
from scenes.draw.meshes import KINDS as MESHES
from scenes.draw.meshes import draw_mesh
from scenes.frame import write_exr, write_text, written_aside
from scenes.mesh import load_mesh
from scenes.schema import PHYSICAL
from scenes.suite import Budget, Suite

COUNT = 8  # cases, in which every kind of environment is met once
WIDER = 1.5  # how far off a case may be that nobody has seen, over one that is shipped
TRIANGLES = (500, 2_000, 10_000, 50_000, 200_000)
COUNTS = (1, 2, 3, 4)  # of objects
FEWEST_TRIANGLES = 300
SMALL = "drawn at random: far away, or behind others"


def draw_suite(
    base: Suite, named: str, seed: int, count: int, folder: Path, detail: float = 1.0
) -> Path:
    """Write a suite of `count` cases drawn from a seed; return the path of its file.

    Case k is the same however many are drawn, on every machine.

    Args:
        base: what techniques, truths, model, sampling and budgets it has (see `budgets`).
        named: what the base is called.
        folder: for the files: `suite.toml`, and a folder for each case.
        detail: the share of texels a side and of triangles to make; 1 for all.
    """
    # Without eta and k a metal can be traced under no exact model.
    exact = base.model.fresnel == "exact" or all(t.startswith("physical") for t in base.truths)
    runs = [_case(seed, k, folder, base, exact, detail) for k in range(count)]
    suite = base.model_copy(update={"run": (), "budget": budgets(base)})
    fields = suite.model_dump(mode="json", exclude_defaults=True, exclude_none=True)
    plural = "s" * (count != 1)
    fields["description"] = (
        f"{count} case{plural} drawn at random from seed {seed}, as {named} asks"
    )
    again = f"# Made by `--suite {named} --draw {seed} --count {count}`, which writes it anew.\n\n"
    path = folder / "suite.toml"
    write_text(path, again + tomlkit.dumps(fields | {"run": runs}))
    return path


def budgets(base: Suite) -> tuple[Budget, ...]:
    """The base's budgets that hold everywhere, WIDER times as wide: others name its own cases."""
    # Not what single runs of the base ask beyond that, by techniques or a model of their own.
    asked = (*base.techniques, "candidate")
    truths = [t for t in base.truths if base.model == PHYSICAL or not t.startswith("physical")]
    return tuple(
        Budget(technique=rule.technique, truth=rule.truth, **_wider(rule))
        for rule in base.budget
        if not rule.selectors and rule.technique in asked and rule.truth in truths
    )


def _wider(rule: Budget) -> dict[str, float]:
    """A rule's limits, each leaving WIDER times as much room for error."""
    limits = {}
    for metric in ("energy_error", "energy_local"):
        if (limit := getattr(rule, metric)) is not None:
            limits[metric] = round(WIDER * limit, 6)
    if "energy_error" in limits:  # a black picture has 1
        limits["energy_error"] = min(limits["energy_error"], 0.999)
    for metric in ("ssim", "silhouette"):
        if (limit := getattr(rule, metric)) is not None:
            limits[metric] = max(round(1 - WIDER * (1 - limit), 6), 0.0)
    return limits


def _case(
    seed: int, number: int, folder: Path, base: Suite, exact: bool, detail: float
) -> dict[str, Any]:
    """Draw one case, write its files, and return its [[run]]."""
    home = folder / str(number)
    home.mkdir(parents=True, exist_ok=True)
    light = dealt(seed, "environments", tuple(ENVIRONMENTS), number)
    radiance = draw_environment(light, stream(seed, number, "environment"), detail)
    with written_aside(home / f"{light}.exr") as aside:
        write_exr(aside, radiance, ["R", "G", "B"])
    setting = dealt(seed, "settings", SETTINGS, number)
    bodies = _bodies(seed, number, home, setting, detail)
    planes = standing(stream(seed, number, "planes"), bodies, setting)
    shot = draw_camera(stream(seed, number, "camera"), bodies, planes)
    objects = [_standing(b, shot.pixels[b.name]) for b in bodies]
    objects += [_flat(p, shot.pixels[p.name]) for p in planes]
    bare = False
    for place, entry in enumerate(objects):
        rng = stream(seed, number, "material", place)
        word, fields = draw_material(rng, exact) if place < len(bodies) else draw_paint(rng)
        bare |= fields["metallic"] > 0 and not isinstance(fields["metal"], str)
        entry["material"] = f"{entry['name']}_{word}.toml"
        write_text(home / entry["material"], tomlkit.dumps(fields))
    scene = f"drawn{seed}-{number}"
    camera = {"origin": shot.origin, "target": shot.target, "fov": shot.fov}
    told = f"{', '.join(o['name'] for o in objects)}, lit by {light.replace('_', ' ')}"
    fields = {"description": told, "resolution": shot.size, "camera": camera, "object": objects}
    write_text(home / f"{scene}.toml", tomlkit.dumps(fields))
    run = {
        "scene": f"{number}/{scene}.toml",
        "environments": [f"{number}/{light}.exr"],
        "rotation": within(stream(seed, number, "rotation"), 0, 360),
    }
    kept = [t for t in base.truths if not (bare and t.startswith("physical"))]
    return run | ({"truths": kept} if len(kept) < len(base.truths) else {})


def _bodies(seed: int, number: int, home: Path, setting: str, detail: float) -> list[Body]:
    """One to four objects, made, written and placed."""
    rng, bodies = stream(seed, number, "objects"), []
    before = sum(dealt(seed, "counts", COUNTS, k) for k in range(number))
    for place in range(dealt(seed, "counts", COUNTS, number)):
        kind = dealt(seed, "meshes", ("sphere", *MESHES), before + place)
        name = kind if all(kind != b.name for b in bodies) else f"{kind}{place + 1}"
        if kind == "sphere":
            mesh = load_mesh(kind)
        else:
            triangles = dealt(seed, "triangles", TRIANGLES, before + place)
            fewer = max(round(triangles * detail), FEWEST_TRIANGLES)
            mesh = draw_mesh(kind, stream(seed, number, "mesh", place), fewer)
            with written_aside(home / f"{name}.ply") as aside:
                mesh.export(aside, "ply", vertex_normal=True)
        bodies.append(pose(rng, name, mesh, setting in GROUNDED))
    return arranged(rng, bodies, setting in GROUNDED)


def _standing(body: Body, pixels: float) -> dict[str, Any]:
    """A body as its scene writes it, but for its material."""
    mesh = "sphere" if body.name.startswith("sphere") else f"{body.name}.ply"
    fields = {"name": body.name, "mesh": mesh, "position": body.position}
    fields |= {"rotate": body.rotate, "scale": body.scale}
    return fields | ({} if pixels >= ENOUGH else {"small": SMALL})


def _flat(plane: Plane, pixels: float) -> dict[str, Any]:
    """A plane as its scene writes it, but for its material; judged where enough of it is seen."""
    fields = {"name": plane.name, "mesh": "plane", "position": plane.position}
    fields |= {"rotate": plane.rotate, "scale": (*plane.size, 1.0)}
    return fields | ({} if pixels >= ENOUGH else {"judged": False})
