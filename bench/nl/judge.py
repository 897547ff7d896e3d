"""See bench/nl/run."""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import casadi
import numpy as np

BENCH = Path(__file__).resolve().parent.parent
ROOT = BENCH.parent
# Both sides round differently: this many units in the last place of the largest number involved.
TOLERANCE = 1e-9
# Relative difference of two optima that are the same.
SAME_OPTIMUM = 1e-6
POINTS = 3


def build(folder, is_built):
    """The three programs: ntg, its evaluator, and the outside reader."""
    cargo = ["cargo", "build", "--release", "--quiet"]
    for package, workspace in [] if is_built else [("ntg-cli", ROOT), ("ntg-bench-program", BENCH)]:
        subprocess.run([*cargo, "--package", package, "--manifest-path", workspace / "Cargo.toml"], check=True)
    wheel = Path(casadi.__file__).parent
    reader = folder / "asl_ipopt"
    include = ["-I/usr/include/ampl-netlib-solvers", f"-I{wheel}/include/coin-or"]
    link = ["-lamplsolver", wheel / "libipopt.so.3", f"-Wl,-rpath,{wheel}", "-lm"]
    subprocess.run(["gcc", "-O2", "-w", BENCH / "nl" / "asl_ipopt.c", *include, "-o", reader, *link], check=True)
    return ROOT / "target" / "release" / "ntg", BENCH / "target" / "release" / "evaluate", reader


def parse(line, n, m):
    """Objective, gradient, rows, dense Jacobian of one line; None where there is no number."""
    if line.startswith("not finite"):
        return None
    left, right = line.split("J")
    numbers = np.array(left.split(), float)
    jacobian = np.zeros((m, n))
    entries = right.split()
    for i, j, value in zip(entries[0::3], entries[1::3], entries[2::3]):
        jacobian[int(i), int(j)] += float(value)
    return numbers[:1], numbers[1 : 1 + n], numbers[1 + n :], jacobian


def difference(pairs):
    """The largest difference over all points, relative to the largest number of its kind: at a start a number may be rounding alone."""
    worst = 0.0
    for kind in range(4):
        ours, theirs = (np.concatenate([pair[side][kind].ravel() for pair in pairs]) for side in (0, 1))
        if not np.all(np.isfinite(theirs)):
            return float("inf")
        size = max(np.abs(ours).max(initial=0.0), np.abs(theirs).max(initial=0.0))
        if size > 0:
            worst = max(worst, float(np.abs(ours - theirs).max() / size))
    return worst


def by_casadi(path, points):
    """CasADi's values at the points, or why it cannot read the file."""
    builder = casadi.NlpBuilder()
    try:
        builder.import_nl(str(path))
    except RuntimeError as error:
        return str(error).strip().split("\n")[-1].split(":")[-1].strip()
    x = casadi.veccat(*builder.x) if isinstance(builder.x, list) else builder.x
    g = casadi.veccat(*builder.g) if isinstance(builder.g, list) else builder.g
    # CasADi minimises: what is maximised has changed its sign.
    f = -builder.f if "\nO0 1\n" in path.read_text() else builder.f
    together = casadi.Function("nl", [x], [f, casadi.gradient(f, x), g, casadi.jacobian(g, x)])
    return [[np.array(part.full()) for part in together(point)] for point in points]


def run(command, **more):
    return subprocess.run(command, capture_output=True, text=True, **more)


def evaluations(spec, nl, tools, rng):
    """What the readers differ by: a dict of solver -> difference or reason."""
    ntg, evaluate, reader = tools
    first = run([evaluate, spec], input="")
    start = np.array(first.stdout.split(), float)
    n = len(start)
    size = np.where(np.abs(start) > 0, np.abs(start), np.abs(start).max(initial=1.0) or 1.0)
    points = [start + 0.02 * k * rng.standard_normal(n) * size for k in range(POINTS)]
    text = "\n".join(" ".join(repr(float(v)) for v in point) for point in points)
    rows = sum(1 for _ in open(nl.with_suffix(".row"))) - 1
    ours = [parse(line, n, rows) for line in run([evaluate, spec], input=text).stdout.splitlines()[1:]]
    asl = run([reader, "eval", nl], input=text)
    theirs = [parse(line, n, rows) for line in asl.stdout.splitlines()]
    if len(theirs) < len(ours):
        return {"asl": (asl.stderr or "no answer").strip().split("\n")[-1], "points": 0}
    pairs = [(a, b) for a, b in zip(ours, theirs) if a is not None]
    if not pairs:
        return {"asl": "no point has a value", "points": 0}
    found = {"asl": difference(pairs), "points": len(pairs)}
    read = by_casadi(nl, points)
    if isinstance(read, str):
        found["casadi"] = read
    else:
        found["casadi"] = difference([(a, b) for a, b in zip(ours, read) if a is not None])
    return found


def solves(spec, nl, tools, seconds):
    """The optimum of the file by IPOPT, judged by ntg, beside ntg's own."""
    ntg, _, reader = tools
    answer = run([reader, "solve", nl, "1e-8", str(seconds)], timeout=10 * seconds)
    try:
        ipopt = json.loads(answer.stdout.splitlines()[-1])
    except (ValueError, IndexError):
        return {"ipopt": (answer.stderr or "no answer").strip()[-60:]}
    judged = run([ntg, "check-solution", spec, nl.with_suffix(".sol"), "--format", "json"])
    own = run([ntg, "solve", spec, "--format", "json", "--time-limit", str(seconds)])
    try:
        judged = json.loads(judged.stdout)
    except ValueError:
        return {"ipopt": f"status {ipopt['status']}", "judge": judged.stderr.strip()[-80:]}
    try:
        own = json.loads(own.stdout)
    except ValueError:
        own = {"status": "refused", "objective": None}
    return {"status": ipopt["status"], "iterations": ipopt["iterations"], "judged": judged, "own": own}


def specs(paths):
    for path in paths or [ROOT / "specs"]:
        path = Path(path)
        yield from sorted(path.rglob("*.ntg")) if path.is_dir() else [path]


def shown(found):
    """A difference in short, or why there is none."""
    return f"{found:.1e}" if isinstance(found, float) else str(found)


def judged(spec, folder, tools, rng, options):
    """A line about one spec, and whether anything differs."""
    nl = folder / f"{spec.stem}.nl"
    done = run([tools[0], "export", spec, "-o", nl, "--force"])
    if done.returncode != 0:
        return f"not exported: {done.stderr.strip()}", False
    found = evaluations(spec, nl, tools, rng)
    # A reader that does not know an operation says so; only the library must read all.
    is_wrong = not (isinstance(found["asl"], float) and found["asl"] <= TOLERANCE)
    is_wrong |= isinstance(found.get("casadi"), float) and not found["casadi"] <= TOLERANCE
    size = nl.stat().st_size / 1e6
    line = f"{size:6.2f} MB, {found['points']} points: ASL {shown(found['asl'])}, CasADi {shown(found.get('casadi'))}"
    if options.no_solve:
        return line, is_wrong
    solved = solves(spec, nl, tools, options.seconds)
    if "judged" not in solved:
        return f"{line}; {solved}", is_wrong
    judge, own = solved["judged"], solved["own"]
    a, b = judge["objective"], own["objective"]
    is_same = a is not None and b is not None and abs(a - b) <= SAME_OPTIMUM * max(abs(a), abs(b), 1e-12)
    verdict = "a solution" if judge["solution"] else "no solution"
    line += f"; IPOPT status {solved['status']}, {solved['iterations']} iterations, {a}, {verdict}; ntg {own['status']:.20} {b}"
    both = solved["status"] == 0 and own["status"] == "solved"
    if both and not is_same:
        line += "; another optimum"
    if solved["status"] == 0 and not judge["solution"]:
        return f"{line}; THE JUDGE DENIES IT", True
    return line, is_wrong


def main():
    parser = argparse.ArgumentParser(description="Judges what `ntg export` writes.")
    parser.add_argument("paths", nargs="*", help="specs and folders; by default specs/")
    parser.add_argument("--no-solve", action="store_true", help="only evaluate")
    parser.add_argument("--no-build", action="store_true", help="take the programs as they were built last")
    parser.add_argument("--seconds", type=float, default=20, help="limit of each solve")
    options = parser.parse_args()
    rng = np.random.default_rng(1)
    wrong = []
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        tools = build(folder, options.no_build)
        for spec in specs(options.paths):
            line, is_wrong = judged(spec, folder, tools, rng, options)
            print(f"{spec.stem:<34} {line}", flush=True)
            if is_wrong:
                wrong.append(spec.stem)
    print("all the same" if not wrong else f"differ: {', '.join(wrong)}")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
