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
IGNORED_FILES = {"log.txt", "program.json", "checksums.txt"}
STATE_VERBS = ["point", "map", "dispersion", "speeds", "check"]

# Settings that shorten long cases. Grids with regions, receivers or sources at given positions are not changed.
SHORT_SETTINGS = {
    ("run", "dynamics/explosion.toml"): ["time.duration=0.02"],
    ("run", "dynamics/foundation.toml"): ["time.duration=0.01"],
    ("run", "dynamics/lamb-2d.toml"): ["time.duration=0.1"],
    ("run", "dynamics/lamb-3d.toml"): ["time.duration=0.03"],
    ("run", "dynamics/resonance.toml"): ["time.duration=0.004"],
    ("run", "dynamics/surface-pulse.toml"): ["time.duration=0.03"],
    ("check", "check/grid-dependence.toml"): ["check.cells=[32, 64]"],
}


def list_verbs(path):
    """Verbs to run on a case; a verb that does not accept it must refuse it in both builds."""
    folder = path.parent.name
    if folder == "dynamics":
        return ["run", "point", "check"]
    if folder == "flow":
        return ["run", "point", "map", "check"]
    if folder == "porous":
        return ["shocks", "run", "check"]
    if folder == "rheology":
        return ["diagram"]
    if folder == "equations":
        return ["point", "map", "check"]
    return STATE_VERBS


def run_program(program, verb, case, out, sets):
    command = [str(program), verb, str(case), "--out", str(out)]
    for setting in sets:
        command += ["--set", setting]
    completed = subprocess.run(command, capture_output=True, text=True)
    hide_folder = lambda text: text.replace(str(out), "OUT")
    return completed.returncode, hide_folder(completed.stdout), hide_folder(completed.stderr)


def find_differences(old, new, allowed):
    """Yields the files that differ between two folders or are missing in one of them."""
    names = lambda folder: {p.relative_to(folder) for p in folder.rglob("*") if p.is_file()}
    all_names = names(old) | names(new)
    for name in sorted(all_names):
        if name.name in IGNORED_FILES | allowed:
            continue
        old_file, new_file = old / name, new / name
        if not (old_file.is_file() and new_file.is_file()):
            yield f"{name}: in one folder alone"
        elif not (filecmp.cmp(old_file, new_file, shallow=False) or is_same_report(old_file, new_file)):
            yield f"{name}: differs"


def is_same_report(old, new):
    """Whether two JSON reports are equal line by line, except for the version of their schema."""
    if old.suffix != ".json":
        return False
    lines = [line for line in new.read_text().splitlines() if not line.startswith('  "schema": ')]
    return lines == old.read_text().splitlines()


def compare_case(programs, verb, path, full, allowed):
    name = str(path.relative_to(CASES))
    sets = [] if full else SHORT_SETTINGS.get((verb, name), [])
    with tempfile.TemporaryDirectory() as base:
        folders = [pathlib.Path(base, label) for label in ("old", "new")]
        results = [run_program(p, verb, path, f, sets) for p, f in zip(programs, folders)]
        (old_code, old_out, _), (new_code, new_out, new_error) = results
        if old_code != new_code:
            yield f"exit code {old_code}, now {new_code}: {new_error.strip()}"
        if old_out != new_out and "stdout" not in allowed:
            yield "standard output differs"
        for folder in folders:
            folder.mkdir(exist_ok=True)
        yield from find_differences(*folders, allowed)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("old", type=pathlib.Path)
    parser.add_argument("new", type=pathlib.Path)
    parser.add_argument("--only", default="", help="cases whose path holds this text")
    parser.add_argument("--full", action="store_true", help="long cases at full length")
    parser.add_argument("--allow", action="append", default=[], help="a file that may differ")
    options = parser.parse_args()
    programs = [options.old.resolve(), options.new.resolve()]
    count = 0
    for path in sorted(CASES.glob("*/*.toml")):
        if options.only not in str(path):
            continue
        for verb in list_verbs(path):
            for line in compare_case(programs, verb, path, options.full, set(options.allow)):
                count += 1
                print(f"{verb} {path.relative_to(CASES)}: {line}", flush=True)
        print(f"{path.relative_to(CASES)}: compared", file=sys.stderr, flush=True)
    print(f"{count} differences")
    return 1 if count else 0


if __name__ == "__main__":
    sys.exit(main())
