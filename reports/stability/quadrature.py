"""Facets to integrate over, with nodes where the lobe is and panels that end at kinks.

As seen from wo at theta_o, a facet at theta_h, phi faces away where wo.h < 0, is masked by its
V-cavity where wo.h > 2 n.h n.wo, and mirrors wo to wi below the surface where 2 wo.h n.h < n.wo;
the cavity shadows wi where wo.h > 2 n.h n.wi, and more than it masks wo where n.wi < n.wo. At a
given theta_h each begins at an azimuth of closed form,

    cos phi = cot theta_o k,
    k = -cot theta_h, cot theta_h, -cot 2 theta_h, (3 - 4 c²) / (4 c² - 1) cot theta_h, tan theta_h

with c = n.h, and in theta_h where that reaches ±1. Nodes follow tan theta_h = alpha tan s.
"""

from dataclasses import dataclass

import numpy as np

from reports.panels import panels

POLAR, AROUND = 24, 8  # Gauss-Legendre nodes per panel


@dataclass(frozen=True)
class Facets:
    """Nodes of an integral over half vectors h.

    Attributes:
        wo: the direction that sees them, (3,), in the plane y = 0.
        h: (n, 3).
        wo_h: their cosine to wo, (n,), negative where they face away.
        omega: solid angle of each, (n,); both sides of the plane y = 0 count.
    """

    wo: np.ndarray
    h: np.ndarray
    wo_h: np.ndarray
    omega: np.ndarray


def facets(alpha: float, cosine: float) -> Facets:
    """Nodes for a lobe of width alpha seen at a cosine to n in (0, 1]."""
    theta_o = np.arctan2(np.sqrt(1 - cosine**2), cosine)
    x = np.pi / 2 - theta_o
    kinks = np.array([x, x / 2, x / 3, np.pi / 4, np.pi / 2 - theta_o / 2, theta_o, theta_o / 2])
    inner = np.sort(np.clip(kinks, 0, np.pi / 2))
    ends = np.concatenate([[0], np.arctan(np.tan(inner) / alpha), [np.pi / 2]])
    # Where the kinks lie close to 0 or to the horizon, the lobe itself would have no nodes.
    ends = np.sort(np.concatenate([ends, [np.pi / 4]]))
    s, ds = panels(ends, POLAR)
    tan = alpha * np.tan(s)
    theta = np.arctan(tan)
    stretch = alpha / np.cos(s) ** 2 / (1 + tan**2)

    cot_o = cosine / max(np.sqrt(1 - cosine**2), 1e-12)
    c2 = np.cos(theta) ** 2
    with np.errstate(divide="ignore", invalid="ignore"):
        shadowed = (3 - 4 * c2) / (4 * c2 - 1) / tan
        k = np.stack([-1 / tan, 1 / tan, -1 / np.tan(2 * theta), shadowed, tan])
    turns = np.arccos(np.clip(np.nan_to_num(cot_o * k), -1, 1))
    ends = np.sort(np.stack([0 * theta, *turns, np.pi + 0 * theta], axis=1))
    phi, dphi = panels(ends, AROUND)

    sin, cos = np.sin(theta)[:, None], np.cos(theta)[:, None]
    h = np.stack([sin * np.cos(phi), sin * np.sin(phi), cos + 0 * phi], axis=2)
    wo = np.array([np.sin(theta_o), 0.0, cosine])
    omega = 2 * dphi * (np.sin(theta) * stretch * ds)[:, None]
    h, omega = h.reshape(-1, 3), omega.ravel()
    return Facets(wo, h, h @ wo, omega)
