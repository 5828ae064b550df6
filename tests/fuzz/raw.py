"""Mutations of bytes, whatever they mean."""

import random
import struct
from collections.abc import Callable

NUMBERS = (0, 1, 0x7F, 0x80, 0xFF, 0x7FFF, 0xFFFF, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 1 << 24)


def _flip(data: bytearray, rng: random.Random) -> None:
    for _ in range(rng.choice((1, 1, 4, 32))):
        data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)


def _number(data: bytearray, rng: random.Random) -> None:
    value = struct.pack(rng.choice("<>") + "I", rng.choice(NUMBERS))
    place = rng.randrange(len(data))
    data[place : place + 4] = value


def _truncate(data: bytearray, rng: random.Random) -> None:
    del data[rng.randrange(len(data)) :]


def _cut(data: bytearray, rng: random.Random) -> None:
    place = rng.randrange(len(data))
    del data[place : place + rng.choice((1, 4, 64, 1000))]


def _zero(data: bytearray, rng: random.Random) -> None:
    place = rng.randrange(len(data))
    size = min(rng.choice((1, 8, 64, 1000)), len(data) - place)
    data[place : place + size] = bytes(size)


def _insert(data: bytearray, rng: random.Random) -> None:
    place = rng.randrange(len(data))
    data[place:place] = rng.randbytes(rng.choice((1, 4, 64, 5000)))


def _repeat(data: bytearray, rng: random.Random) -> None:
    place = rng.randrange(len(data))
    data[place:place] = data[place : place + rng.choice((2, 40, 400))] * rng.choice((1, 50, 500))


def _move(data: bytearray, rng: random.Random) -> None:
    start = rng.randrange(len(data))
    place = rng.randrange(len(data))
    part = data[start : start + rng.choice((4, 40, 400))]
    data[place : place + len(part)] = part


MUTATIONS = (_flip, _number, _truncate, _cut, _zero, _insert, _repeat, _move)


def mutated(data: bytes, other: bytes, rng: random.Random) -> tuple[bytes, str]:
    """The bytes with one to three mutations, or spliced with another file; and what was done."""
    if rng.random() < 0.08:
        start, end = rng.randrange(len(data)), rng.randrange(len(other))
        return data[:start] + other[end:], "splice"
    made, done = bytearray(data), []
    for _ in range(rng.choice((1, 1, 2, 3))):
        change: Callable = rng.choice(MUTATIONS)
        if made:
            change(made, rng)
            done.append(change.__name__.strip("_"))
    return bytes(made), "+".join(done)
