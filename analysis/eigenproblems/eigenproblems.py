"""Complex generalised eigenproblems per second on one core, all on the same matrices, in turn:
this crate (its equilibration included), faer, LAPACK's zggev called from C, and SciPy.

    cargo build --release --manifest-path analysis/eigenproblems/Cargo.toml    # BENCH: target/release/eigenproblems
    cc -O2 analysis/eigenproblems/zggev.c -o ZGGEV -llapack -lblas
    python3 analysis/eigenproblems/eigenproblems.py BENCH ZGGEV=LIBRARIES... [--rounds 7]

ZGGEV is run once for each LIBRARIES, a folder for LD_LIBRARY_PATH (with liblapack.so.3 and
libblas.so.3 of reference LAPACK, of OpenBLAS), or nothing after `=` for the system's own.
Needs NumPy and SciPy.
"""

import argparse
import os
import statistics
import struct
import subprocess
import tempfile
import time

ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
os.environ.update(ONE_THREAD)

import numpy as np  # noqa: E402
import scipy  # noqa: E402
import scipy.linalg  # noqa: E402

NAMES = ["models, n = 4", "models, n = 5", "models, n = 6", "random, n = 9, rank R = 6",
         "random, n = 10, rank R = 10"]


class Program:
    """A program that answers a line with a line."""

    def __init__(self, command, library=""):
        environment = dict(os.environ)
        if library:
            environment["LD_LIBRARY_PATH"] = library
        self.process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=environment)
        assert self.process.stdout.readline() == "ready\n", command

    def rates(self, number):
        self.process.stdin.write(f"{number}\n")
        self.process.stdin.flush()
        return [float(word) for word in self.process.stdout.readline().split()]


def read(path):
    with open(path, "rb") as file:
        (sets,) = struct.unpack("<Q", file.read(8))
        for _ in range(sets):
            n, count = struct.unpack("<QQ", file.read(16))
            data = np.frombuffer(file.read(32 * n * n * count), dtype="<c16")
            # By columns.
            yield np.ascontiguousarray(data.reshape(count, 2, n, n).transpose(0, 1, 3, 2))


def scipy_rate(problems):
    solved, start = 0, time.perf_counter()
    while True:
        for left, right in problems:
            scipy.linalg.eig(left, right, right=False)
        solved += len(problems)
        elapsed = time.perf_counter() - start
        if elapsed > 0.5:
            return solved / elapsed


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bench")
    parser.add_argument("zggev", nargs="+", metavar="ZGGEV=LIBRARIES")
    parser.add_argument("--rounds", type=int, default=7)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "matrices")
        own = Program([arguments.bench, path])
        lapacks = []
        for item in arguments.zggev:
            command, _, library = item.partition("=")
            lapacks.append(Program([command, path], library))
        sets = list(read(path))
        np.seterr(all="ignore")
        columns = ["ours", "faer"]
        columns += [f"zggev {number + 1}" for number in range(len(lapacks))] + ["SciPy"]
        print(f"SciPy {scipy.__version__}; problems/s, medians of {arguments.rounds} rounds; "
              "ratios: medians of those within a round")
        print("| set | " + " | ".join(columns) + " | ours/faer | ours/zggev (fastest) | ours/SciPy |")
        print("|---" * (len(columns) + 4) + "|")
        rounds = [[] for _ in sets]
        for _ in range(arguments.rounds):
            for number, problems in enumerate(sets):
                rates = own.rates(number)
                for program in lapacks:
                    rates += program.rates(number)
                rounds[number].append(rates + [scipy_rate(problems)])
        for name, rates in zip(NAMES, rounds):
            medians = [statistics.median(column) for column in zip(*rates)]
            ratios = [statistics.median(ratio) for ratio in zip(
                *([r[0] / r[1], r[0] / max(r[2:-1]), r[0] / r[-1]] for r in rates))]
            print(f"| {name} | " + " | ".join(f"{m:,.0f}".replace(",", " ") for m in medians)
                  + " | " + " | ".join(f"{ratio:.2f}" for ratio in ratios) + " |")


if __name__ == "__main__":
    main()
