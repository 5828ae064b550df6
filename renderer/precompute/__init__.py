"""Maps made once per environment, on the GPU: one file each, one row each in MAPS."""

from collections.abc import Callable, Collection, Iterable
from functools import lru_cache
from pathlib import Path
from time import perf_counter

import moderngl

from renderer.context import context
from renderer.precompute import blurred, brdf_table, irradiance, prefilter, radiance, split
from renderer.program import Maps
from scenes.schema import file_digest

BASE = "radiance_map"
# Each maker takes the radiance map and the names of what is wanted, and returns just that.
MAKERS: dict[str, Callable[[moderngl.Texture, Collection[str]], Maps]] = {
    "irradiance_map": irradiance.make,
    "irradiance_map_fine": irradiance.make,
    "prefiltered_ggx": prefilter.make,
    "prefiltered_beckmann": prefilter.make,
    "blurred_map": blurred.make,
    "lights_map": blurred.make,
    "lobe_ggx": split.make_lobes,
    "lobe_beckmann": split.make_lobes,
    "irradiance_exact": split.make_irradiance,
    "irradiance_sky": split.make_irradiance,
    **dict.fromkeys(("albedo_ggx", "albedo_beckmann"), split.make_tables),
    **dict.fromkeys(("towards_ggx", "towards_beckmann"), split.make_tables),
    "table_ggx": brdf_table.make,
    "table_beckmann": brdf_table.make,
    "table_ggx_fine": brdf_table.make_fine,
    "table_beckmann_fine": brdf_table.make_fine,
}


class Precomputed:
    """The maps of one environment, made when first asked for.

    Attributes:
        maps: by the name of their sampler in GLSL; always holds "radiance_map".
        seconds: time spent, by the names that were made together.
    """

    def __init__(self, path: Path) -> None:
        start = perf_counter()
        self.maps: Maps = {BASE: radiance.make(path)}
        context().finish()
        self.seconds = {(BASE,): perf_counter() - start}

    def cost(self, names: Collection[str]) -> float:
        """Seconds that the named maps took, with the radiance map under them all.

        Maps that were made together count in full for each.
        """
        wanted = {BASE, *names}
        return sum(seconds for made, seconds in self.seconds.items() if wanted & set(made))

    def need(self, names: Iterable[str]) -> None:
        """Make the named maps that are not there yet, those of one maker together."""
        lacking: dict[Callable, list[str]] = {}
        for name in names:
            if name not in self.maps:
                lacking.setdefault(MAKERS[name], []).append(name)
        for make, together in lacking.items():
            start = perf_counter()
            self.maps |= make(self.maps[BASE], together)
            context().finish()
            self.seconds[tuple(together)] = perf_counter() - start


def precomputed(path: Path) -> Precomputed:
    """The maps of an environment file; kept for the last few environments."""
    return _cached(path, file_digest(path))


@lru_cache(maxsize=4)
def _cached(path: Path, _digest: str) -> Precomputed:
    return Precomputed(path)
