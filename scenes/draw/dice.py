"""Random numbers that are the same on every machine, and decks that leave nothing out."""

import zlib

import numpy as np

Rng = np.random.Generator


def stream(seed: int, *place: int | str) -> Rng:
    """The random numbers of one place in a draw, such as the camera of its third case.

    Each place has its own: a change in one leaves all others as they were.
    """
    words = [p if isinstance(p, int) else zlib.crc32(p.encode()) for p in place]
    return np.random.default_rng([seed, *words])


def dealt(seed: int, what: str, names: tuple, number: int):
    """The card on place `number` of decks of `names`, each shuffled anew and dealt to its end."""
    deck, place = divmod(number, len(names))
    return names[stream(seed, what, deck).permutation(len(names))[place]]


def within(rng: Rng, low: float, high: float) -> float:
    """A number drawn evenly, to four digits: files stay readable, and the last bits of a libm
    do not reach them."""
    return float(f"{rng.uniform(low, high):.4g}")


def log_within(rng: Rng, low: float, high: float) -> float:
    """A positive number whose logarithm is drawn evenly."""
    return float(f"{low * (high / low) ** rng.random():.4g}")


def one_of(rng: Rng, *items):
    """One of the items."""
    return items[rng.integers(len(items))]


def rounded(numbers: np.ndarray, bits: int) -> np.ndarray:
    """float32 of `bits` significant bits.

    Machines differ in the last of the 53 bits of a sine; so few are left here that they agree.
    """
    mantissa, exponent = np.frexp(np.asarray(numbers, float))
    return np.ldexp(np.round(mantissa * 2.0**bits), exponent - bits).astype(np.float32)
