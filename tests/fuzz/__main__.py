"""Fuzz from the shell.

python -m tests.fuzz --seed 1 --count 1000      # a campaign; what ends wrong is kept
python -m tests.fuzz --seed 1 --from 17         # one input again
"""

import argparse
import sys
import tempfile
import time
from pathlib import Path

from tests.fuzz.campaign import campaign
from tests.fuzz.inputs import SHARES

ENDS = ("taken", "drawn", "refused", "wrong")


def main() -> int:
    """Run a campaign and print what it found; 1 where anything ended wrong."""
    parser = argparse.ArgumentParser(prog="tests.fuzz")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument(
        "--from", type=int, default=0, dest="first", help="number of the first input"
    )
    parser.add_argument("--count", type=int, default=1)
    parser.add_argument("--kind", default="", choices=SHARES, help="run inputs of this kind alone")
    parser.add_argument("--keep", type=Path, help="folder for the inputs that end wrong")
    parser.add_argument("--lines", type=Path, help="file for every refusal")
    options = parser.parse_args()
    keep = options.keep or Path(tempfile.mkdtemp(prefix="fuzz-"))
    keep.mkdir(parents=True, exist_ok=True)
    start = time.perf_counter()
    tally = campaign(
        options.seed, range(options.first, options.first + options.count), keep, options.kind
    )
    took = time.perf_counter() - start
    for given, ended in tally.wrong:
        print(f"#{given.number} {given.kind} ({given.how}): {' | '.join(ended.problems)}")
        print(f"   {' '.join(given.words)}; kept in {keep / str(given.number)}")
    print(f"{'kind':10}" + "".join(f"{end:>9}" for end in ENDS))
    for kind in (*SHARES, "all"):
        sums = [
            sum(n for (k, e), n in tally.counts.items() if e == end and kind in (k, "all"))
            for end in ENDS
        ]
        print(f"{kind:10}" + "".join(f"{n:9}" for n in sums))
    print(f"{options.count} inputs in {took:.0f} s")
    for title, unit, worst in (
        ("slowest", "s", tally.slowest),
        ("hungriest", "MiB", tally.hungriest),
    ):
        for amount, *told in worst:
            print(f"{title}: {amount:.2f} {unit}, #{told[0]} {told[1]} ({told[2]})")
    if options.lines:
        text = "\n".join(f"{kind}\t{how}\t{line}" for kind, how, line in tally.lines)
        options.lines.write_text(text, encoding="utf-8")
    return 1 if tally.wrong else 0


if __name__ == "__main__":
    sys.exit(main())
