"""The table of a case's rows. To add a figure: one line in GROUPS."""

from collections.abc import Callable
from dataclasses import dataclass

from reports.html import figures as f
from reports.html.matrix import Cell, cell
from reports.results import Row

Shown = Cell | str


@dataclass(frozen=True)
class Column:
    """One figure: its heading, what it means, and how a row shows it."""

    heading: str
    meaning: str
    show: Callable[[Row], Shown]


def _budgeted(name: str) -> Callable[[Row], Shown]:
    return lambda row: cell(f.METRICS[name], row)


def _with_interval(
    name: str, show: Callable[[float], str], channel: int | None = None
) -> Callable[[Row], Shown]:
    def shown(row: Row) -> str:
        value, interval = getattr(row, name), getattr(row, f"{name}_ci95")
        if channel is not None:
            value, interval = value[channel], interval[channel]
        return f.within(show(value), interval, show)

    return shown


def _signed(value: float) -> str:
    return f.percent(value, signed=True)


def _small(value: float) -> str:
    return f.number(value, 5)


GROUPS: tuple[tuple[str, tuple[Column, ...]], ...] = (
    ("Energy", (
        Column("local", "root mean square of the energy error of 16×16 blocks, worst channel",
               _budgeted("energy_local")),
        Column("total", "light on the object, candidate over reference, minus 1",
               _budgeted("energy_error")),
        Column("R", "total, red only", _with_interval("energy_rgb", _signed, 0)),
        Column("G", "total, green only", _with_interval("energy_rgb", _signed, 1)),
        Column("B", "total, blue only", _with_interval("energy_rgb", _signed, 2)),
    )),
    ("SSIM, 1 is the same", (
        Column("mean", "after exposure and sRGB, without the reference's noise",
               _budgeted("ssim")),
        Column("raw", "with the reference's noise", _with_interval("ssim_raw", f.similarity)),
        Column("5th pct", "5th percentile of the map: the worst parts of the object",
               _with_interval("ssim_p5", f.similarity)),
        Column("highlights", "three stops darker", _with_interval("ssim_highlights", f.similarity)),
    )),
    ("Other errors", (
        Column("relMSE", "relative squared error, mean over 8×8 blocks",
               _with_interval("relmse", _small)),
        Column("median", "relative squared error, median over 8×8 blocks",
               _with_interval("relmse_median", _small)),
        Column("chroma", "how much duller (−) or more vivid: mean CIELAB chroma after exposure and "
               "sRGB, candidate over reference, minus 1",
               _with_interval("chroma_error", _signed)),
        Column("FLIP", "HDR-FLIP, 0 is the same; bounds for the reference's noise",
               _with_interval("flip", f.similarity)),
        Column("silhouette", "overlap of the two masks, 1 is the same", _budgeted("silhouette")),
        Column("NaN / Inf / <0", "pixels on the object that are no number, infinite, negative",
               lambda r: f"{r.nan_pixels} / {r.inf_pixels} / {r.negative_pixels}"),
        Column("pixels", "pixels that the object covers", lambda r: f.count(r.pixels)),
    )),
    ("Cost", (
        Column("frame", "time of one warm frame, all objects",
               lambda r: f.seconds(r.frame_ms / 1e3)),
        Column("precomp.", "time to prefilter the environment",
               lambda r: f.seconds(r.precomputation_ms / 1e3)),
        Column("reference", "time of path tracing",
               lambda r: f.seconds(r.reference_seconds) if r.reference_spp else f.NONE),
        Column("samples", "path-traced samples per pixel, in independent batches",
               lambda r: f"{f.count(r.reference_spp) if r.reference_spp else f.NONE} spp in "
                         f"{r.reference_batches}"),
    )),
)  # fmt: skip


def cells(row: Row) -> list[Shown]:
    """A row's figures in the order of GROUPS."""
    return [column.show(row) for _, columns in GROUPS for column in columns]
