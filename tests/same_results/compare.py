#!/usr/bin/env python3
"""Compare the results of two builds of wellposed on all shipped cases, file by file and byte by byte.

    python3 tests/same_results/compare.py OLD NEW [--only TEXT] [--full] [--allow FILE ...]

OLD and NEW are the programs. Every case in `cases` is run by every verb that takes it. Long cases are made short
by `--set`, unless --full is given. log.txt (wall times), program.json (version) and checksums.txt (of all files) are left out. Each difference
is printed; the exit code is 1 if there is any. --allow names files of results that may differ, as in `run.txt`.
"""

import argparse
import filecmp
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
CASES = ROOT / "cases"
LEFT_OUT = {"log.txt", "program.json", "checksums.txt"}
STATE_VERBS = ["point", "map", "dispersion", "speeds", "check"]

# What makes a long case short. Grids stay as they are where regions, receivers and sources have places in them.
SHORT = {
    ("run", "dynamics/explosion.toml"): ["time.duration=0.02"],
    ("run", "dynamics/foundation.toml"): ["time.duration=0.01"],
    ("run", "dynamics/lamb-2d.toml"): ["time.duration=0.1"],
    ("run", "dynamics/lamb-3d.toml"): ["time.duration=0.03"],
    ("run", "dynamics/resonance.toml"): ["time.duration=0.004"],
    ("run", "dynamics/surface-pulse.toml"): ["time.duration=0.03"],
    ("check", "check/grid-dependence.toml"): ["check.cells=[32, 64]"],
}


def verbs(path):
    """The verbs that a case is meant for: all are tried, those that refuse it must do so alike."""
    folder = path.parent.name
    if folder == "dynamics":
        return ["run", "point", "check"]
    if folder == "flow":
        return ["run", "point", "map", "check"]
    return STATE_VERBS


def run(program, verb, case, out, sets):
    command = [str(program), verb, str(case), "--out", str(out)]
    for setting in sets:
        command += ["--set", setting]
    done = subprocess.run(command, capture_output=True, text=True)
    hide = lambda text: text.replace(str(out), "OUT")
    return done.returncode, hide(done.stdout), hide(done.stderr)


def differences(old, new, allowed):
    """The files of two folders that differ, or are in one alone."""
    names = lambda folder: {p.relative_to(folder) for p in folder.rglob("*") if p.is_file()}
    ours = names(old) | names(new)
    for name in sorted(ours):
        if name.name in LEFT_OUT | allowed:
            continue
        one, other = old / name, new / name
        if not (one.is_file() and other.is_file()):
            yield f"{name}: in one folder alone"
        elif not (filecmp.cmp(one, other, shallow=False) or same_report(one, other)):
            yield f"{name}: differs"


def same_report(old, new):
    """Whether two reports in JSON are the same, line by line, but for the version of their form."""
    if old.suffix != ".json":
        return False
    lines = [line for line in new.read_text().splitlines() if not line.startswith('  "schema": ')]
    return lines == old.read_text().splitlines()


def compare(programs, verb, path, full, allowed):
    name = str(path.relative_to(CASES))
    sets = [] if full else SHORT.get((verb, name), [])
    with tempfile.TemporaryDirectory() as base:
        folders = [pathlib.Path(base, side) for side in ("old", "new")]
        answers = [run(p, verb, path, f, sets) for p, f in zip(programs, folders)]
        (old_code, old_out, _), (new_code, new_out, new_error) = answers
        if old_code != new_code:
            yield f"exit code {old_code}, now {new_code}: {new_error.strip()}"
        if old_out != new_out and "stdout" not in allowed:
            yield "standard output differs"
        for folder in folders:
            folder.mkdir(exist_ok=True)
        yield from differences(*folders, allowed)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("old", type=pathlib.Path)
    parser.add_argument("new", type=pathlib.Path)
    parser.add_argument("--only", default="", help="cases whose path holds this text")
    parser.add_argument("--full", action="store_true", help="long cases at full length")
    parser.add_argument("--allow", action="append", default=[], help="a file that may differ")
    options = parser.parse_args()
    programs = [options.old.resolve(), options.new.resolve()]
    found = 0
    for path in sorted(CASES.glob("*/*.toml")):
        if options.only not in str(path):
            continue
        for verb in verbs(path):
            for line in compare(programs, verb, path, options.full, set(options.allow)):
                found += 1
                print(f"{verb} {path.relative_to(CASES)}: {line}", flush=True)
        print(f"{path.relative_to(CASES)}: compared", file=sys.stderr, flush=True)
    print(f"{found} differences")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
