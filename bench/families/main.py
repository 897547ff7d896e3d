"""See bench/families/run."""

import argparse
import importlib.util
import json
import random
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
# Families import `case` and what they share from here.
sys.path.insert(0, str(HERE))

import judge  # noqa: E402


def families(only):
    """Modules of the folder by name."""
    found = {path.stem: path for path in sorted((HERE / "families").glob("*.py"))}
    unknown = [name for name in only or () if name not in found]
    if unknown:
        sys.exit(f"families: there is no {', '.join(unknown)}; there are {', '.join(found)}")
    for name in only or found:
        spec = importlib.util.spec_from_file_location(f"families.{name}", found[name])
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        yield name, module


def described(only):
    """A line for each family: its name and the first paragraph of its module."""
    modules = list(families(only))
    width = max(len(name) for name, _ in modules)
    for name, module in modules:
        print(name.ljust(width), " ".join(module.__doc__.split("\n\n")[0].split()))


def drawn(options):
    """Every case with its family. A family's cases depend on the seed and its name alone."""
    for name, module in families(options.only):
        for case in module.cases(random.Random(f"{options.seed} {name}"), options.count):
            yield name, case


def binary(path):
    """The command that is asked; the repository's own is built."""
    if path:
        return path.resolve()
    subprocess.run(["cargo", "build", "--release", "--quiet", "-p", "ntg-cli"], cwd=ROOT, check=True)
    return ROOT / "target" / "release" / "ntg"


def table(answers):
    """Counts of classes and sum of iterations by family."""
    rows = [("family", "cases", *judge.CLASSES, "iterations", "seconds")]
    names = list(dict.fromkeys(one["family"] for one in answers))
    for name in [*names, "all"]:
        mine = [one for one in answers if name in ("all", one["family"])]
        counts = [sum(one["class"] == kind for one in mine) for kind in judge.CLASSES]
        rows.append((name, len(mine), *counts, sum(one["iterations"] for one in mine), f"{sum(one['seconds'] for one in mine):.1f}"))
    widths = [max(len(str(row[k])) for row in rows) for k in range(len(rows[0]))]
    for row in rows:
        cells = [str(cell).rjust(width) for cell, width in zip(row, widths)]
        print("  ".join([str(row[0]).ljust(widths[0]), *cells[1:]]))


def line(one):
    """An answer that is not right, in a line."""
    show = lambda value: "-" if value is None else f"{value:.8g}"
    known = "infeasible" if one["optimum"] is None else show(one["optimum"])
    near = ", near enough" if one["near"] and one["class"] == "accepted" else ""
    return f"{one['class']:9} {one['name']}: exit {one['exit']}, {show(one['objective'])} for {known} ({one['unit']}{near}); {one['said'][:160]}"


def compare(answers, path):
    """What has changed since an earlier run, of the cases that both have."""
    before = {(one["name"], one["spec"]): one for one in json.loads(path.read_text())}
    both = [(before[one["name"], one["spec"]], one) for one in answers if (one["name"], one["spec"]) in before]
    print(f"\nagainst {path}: {len(both)} of {len(answers)} cases are in both")
    for old, new in both:
        if old["class"] != new["class"]:
            print(f"  {new['name']}: {old['class']} -> {new['class']}; {new['said'][:120]}")
    total = lambda pairs: " -> ".join(str(sum(pair[k]["iterations"] for pair in pairs)) for k in (0, 1))
    right = [pair for pair in both if pair[0]["class"] == pair[1]["class"] == "right"]
    print(f"  iterations {total(both)}; of the {len(right)} right in both {total(right)}")


def main():
    parser = argparse.ArgumentParser(description="Families of problems with known answers; bench/families/run says more.")
    parser.add_argument("--seed", type=int, default=1, help="what sizes, units, meshes and guesses are drawn by")
    parser.add_argument("--count", type=int, default=6, help="cases of each family")
    parser.add_argument("--only", type=lambda text: text.split(","), help="names of families, by commas")
    parser.add_argument("--ntg", type=Path, help="the command; without it that of the repository, which is built")
    parser.add_argument("--jobs", type=int, default=1, help="solves at once")
    parser.add_argument("--time-limit", type=float, default=20, help="seconds a solve")
    parser.add_argument("--out", type=Path, help="keeps specs and answers.json there")
    parser.add_argument("--against", type=Path, help="answers.json of an earlier run, to compare with")
    parser.add_argument("--list", action="store_true", help="says what the families are, and solves nothing")
    options = parser.parse_args()
    if options.list:
        described(options.only)
        return
    ntg = binary(options.ntg)
    with tempfile.TemporaryDirectory() as scratch:
        folder = options.out or Path(scratch)
        folder.mkdir(parents=True, exist_ok=True)
        cases = list(drawn(options))
        ask = lambda pair: judge.answer(pair[1], pair[0], ntg, folder / f"{pair[1].name}.ntg", options.time_limit)
        with ThreadPoolExecutor(options.jobs) as pool:
            answers = list(pool.map(ask, cases))
        (folder / "answers.json").write_text(json.dumps(answers, indent=1) + "\n")
    table(answers)
    print()
    for one in answers:
        if one["class"] != "right":
            print(line(one))
    if options.against:
        compare(answers, options.against)


if __name__ == "__main__":
    main()
