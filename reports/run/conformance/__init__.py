"""Holds what the renderer precomputes and samples against its definitions, for a suite's cases."""

from collections.abc import Iterable
from pathlib import Path

import numpy as np

from renderer.precompute import precomputed
from renderer.techniques import Technique, technique
from reports.conformance.light import Light
from reports.conformance.result import Conformance
from reports.run.conformance.filtered import (
    of_filtered_light,
    of_filtered_samples,
    of_taken_out,
)
from reports.run.conformance.geometry import of_edges, of_normals
from reports.run.conformance.light import of_light
from reports.run.conformance.maps import of_maps, of_mirror, of_sizes
from reports.run.conformance.samples import of_samples
from reports.run.conformance.shading import of_beckmann_over_ggx, of_horizon, of_split_sum
from reports.run.conformance.split import of_better_split_sum, of_split_maps, of_split_table
from reports.run.conformance.surfaces import of_surfaces
from reports.run.conformance.tables import of_own_table, of_table
from scenes.environment import load_environment
from scenes.schema import Case, Environment, Material
from scenes.suite import Entry
from scenes.surface import plain

Used = tuple[Case, Material, Technique]
TABLES = ("albedo", "towards")


def conformance(entries: Iterable[Entry]) -> list[Conformance]:
    """The worst differences of each kind, over what the techniques of some entries use."""
    entries = list(entries)
    edges = [of_edges(e.case, name) for e in entries for name in e.techniques]
    found = [e for e in edges if e]
    used = [
        (e.case, plain(o), technique(name))
        for e in entries
        for o in e.case.objects
        for name in e.techniques
    ]
    found += [f for e in entries for name in e.techniques for f in of_surfaces(e.case, name)]
    found.append(of_normals(used[0][0]))
    for environment in {c.environment.path: c.environment for c, _, _ in used}.values():
        found += of_light(environment)
    found += [
        of_horizon(m, c.model) for c, m in {(m, c.model): (c, m) for c, m, _ in used}.values()
    ]
    found += _filtered([u for u in used if u[2].reads])
    found += _better_split([u for u in used if u[2].split])
    used = [u for u in used if not (u[2].reads or u[2].split)]
    split = [(c, m, t) for c, m, t in used if not t.samples]
    read: dict[Environment, set[str]] = {}
    for case, material, how in split:
        read.setdefault(case.environment, set()).update(how.maps(material, case.model))
    found += [of_mirror(e) for e in {e.path: e for e in read}.values()]
    for path in {e.path for e in read}:
        names = set().union(*(maps for e, maps in read.items() if e.path == path))
        precomputed(path).need(sorted(names))
        found += of_sizes(precomputed(path), names)
        found += of_maps(
            precomputed(path), Light(load_environment(path).radiance), names, path.stem
        )
    if split:
        found.append(of_beckmann_over_ggx({m.alpha for _, m, _ in split}))
    tables = {n for names in read.values() for n in names if n.startswith("table")}
    for name in sorted(tables):
        (made := precomputed(next(iter(read)).path)).need([name])
        found.append(of_table(made, name))
    found += [of_own_table(m) for m in {m for c, m, t in split if t.own_table(c.model)}]
    for case, material, how in _each_once(split):
        found.append(of_split_sum(case.environment, material, case.model, how))
    for material, how in {(m, t) for _, m, t in used if t.samples}:
        found += of_samples(material, how)
    return [
        max((f for f in found if f.name == name), key=lambda f: np.nan_to_num(f.off, nan=np.inf))
        for name in dict.fromkeys(f.name for f in found)
    ]


def _filtered(used: list[Used]) -> list[Conformance]:
    """What the technique `filtered` uses."""
    found = [f for m, t in {(m, t) for _, m, t in used} for f in of_filtered_samples(m, t)]
    for environment in {c.environment.path: c.environment for c, _, _ in used}.values():
        found += of_taken_out(environment)
    for case, material, how in _each_once(used):
        found += of_filtered_light(case.environment, material, case.model, how)
    return found


def _better_split(used: list[Used]) -> list[Conformance]:
    """The same of the technique `split`."""
    read: dict[Path, set[str]] = {}
    for case, material, how in used:
        read.setdefault(case.environment.path, set()).update(how.maps(material, case.model))
    environments = {c.environment.path: c.environment for c, _, _ in used}
    found = [f for p, e in environments.items() for f in of_split_maps(e, read[p])]
    tables = {n: e for p, e in environments.items() for n in read[p] if n.startswith(TABLES)}
    found += [of_split_table(name, e) for name, e in tables.items()]
    for case, material, how in _each_once(used):
        found.append(of_better_split_sum(case.environment, material, case.model, how))
    return found


def _each_once(used: list[Used]) -> list[Used]:
    """Each surface in one environment, and each environment with one surface."""
    surfaces = {(m, c.model, t.shade, t.fine): (c, m, t) for c, m, t in used}
    lights = {c.environment: (c, m, t) for c, m, t in used}
    return list(dict.fromkeys([*surfaces.values(), *lights.values()]))
