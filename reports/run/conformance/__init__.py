"""Holds what the renderer precomputes and samples against its definitions, for a suite's cases."""

from collections.abc import Iterable

import numpy as np

from renderer.features import technique
from renderer.precompute import precomputed
from reports.conformance.light import Light
from reports.conformance.result import Conformance
from reports.run.conformance.geometry import of_edges, of_normals
from reports.run.conformance.light import of_light
from reports.run.conformance.maps import of_maps, of_mirror, of_sizes
from reports.run.conformance.samples import of_samples
from reports.run.conformance.shading import of_beckmann_over_ggx, of_horizon, of_split_sum
from reports.run.conformance.surfaces import of_surfaces
from reports.run.conformance.tables import of_own_table, of_table
from scenes.environment import load_environment
from scenes.schema import Environment
from scenes.suite import Entry


def conformance(entries: Iterable[Entry]) -> list[Conformance]:
    """The worst differences of each kind, over what the techniques of some entries use."""
    entries = list(entries)
    edges = [of_edges(e.case, name) for e in entries for name in e.techniques]
    found = [e for e in edges if e]
    used = [
        (e.case, o.material, technique(name))
        for e in entries
        for o in e.case.objects
        for name in e.techniques
    ]
    found += [f for e in entries for name in e.techniques for f in of_surfaces(e.case, name)]
    found.append(of_normals(used[0][0]))
    for environment in {c.environment.path: c.environment for c, _, _ in used}.values():
        found += of_light(environment)
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
    found += [of_table(precomputed(next(iter(read)).path), name) for name in sorted(tables)]
    found += [of_own_table(m) for m in {m for c, m, t in split if t.own_table(c.model)}]
    # Each surface in one environment, and each environment with one surface.
    surfaces = {(m, c.model, t.shade, t.fine): (c, m, t) for c, m, t in split}
    lights = {c.environment: (c, m, t) for c, m, t in split}
    for case, material, how in dict.fromkeys([*surfaces.values(), *lights.values()]):
        found.append(of_split_sum(case.environment, material, case.model, how))
    found += [
        of_horizon(m, c.model) for c, m in {(m, c.model): (c, m) for c, m, _ in used}.values()
    ]
    for material, how in {(m, t) for _, m, t in used if t.samples}:
        found += of_samples(material, how)
    return [
        max((f for f in found if f.name == name), key=lambda f: np.nan_to_num(f.off, nan=np.inf))
        for name in dict.fromkeys(f.name for f in found)
    ]
