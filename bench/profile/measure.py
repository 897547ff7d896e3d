"""Asks both solvers, one process a question, and keeps every answer."""

import json
import subprocess
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import casadi

BENCH = Path(__file__).resolve().parent.parent
ROOT = BENCH.parent
RESULTS = Path(__file__).resolve().parent / "results.jsonl"
HELD_OUT = Path(__file__).resolve().parent / "held_out"
FOLDERS = [ROOT / "specs", ROOT / "specs" / "gallery"]
SOLVERS = ("ntg", "ipopt")
MESHES = (1.0, 0.5, 2.0)
STARTS = 10
# Meshes and starts that stand for all of them where the solver is tried out (docs/maths.md, sections 11.2 and 11.12).
SAMPLE = [(1.0, 0), (1.0, 1), (1.0, 2), (2.0, 1), (0.5, 0)]
# Seconds beyond the limit after which a process is ended.
GRACE = 20


def binary(is_built):
    """The binary of bench/ipopt."""
    path = BENCH / "target" / "release" / "ipopt-compare"
    if is_built:
        return path
    build = ["cargo", "build", "--release", "--quiet", "--package", "ntg-bench-ipopt"]
    subprocess.run([*build, "--manifest-path", BENCH / "Cargo.toml"], check=True)
    return path


def hold_out():
    """From here on the specs are those that nothing was fitted to, with results of their own."""
    global FOLDERS, RESULTS
    FOLDERS = [HELD_OUT]
    RESULTS = HELD_OUT / "results.jsonl"


def specs(only):
    """Specs by name, those of the gallery after the others."""
    found = [path for folder in FOLDERS for path in sorted(folder.glob("*.ntg"))]
    return [path for path in found if not only or path.stem in only]


def questions(options):
    """All (spec, mesh, start, solver), the cheap half first: every spec's own mesh and start."""
    paths = specs(options.only)
    pairs = [(1.0, 0)] if options.quick else SAMPLE if options.sample else [(mesh, start) for start in range(STARTS) for mesh in MESHES]
    return [(path, mesh, start, solver) for mesh, start in pairs for path in paths for solver in SOLVERS]


def key(path, mesh, start, solver):
    return f"{path.relative_to(ROOT)} {mesh} {start} {solver}"


def known():
    """Answers of earlier runs by question. A line that was cut off is asked again."""
    answers = {}
    if RESULTS.exists():
        for line in RESULTS.read_text().splitlines():
            try:
                answer = json.loads(line)
                answers[answer["question"]] = answer
            except (ValueError, KeyError):
                continue
    return answers


def ask(program, question, limit):
    path, mesh, start, solver = question
    library = Path(casadi.__file__).parent / "libipopt.so.3"
    command = [program, path, "--one", solver, "--library", library, "--time-limit", str(limit)]
    command += ["--mesh", str(mesh), "--start", str(start)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=limit + GRACE)
        lines = [line for line in done.stdout.splitlines() if line.startswith("{")]
        answer = json.loads(lines[-1]) if lines else {"solved": False, "status": f"exit {done.returncode}"}
    except subprocess.TimeoutExpired:
        answer = {"solved": False, "status": f"ended after {limit + GRACE} s"}
    return {"question": key(*question), "limit": limit, **answer}


def measure(options):
    """Asks what has not been asked; gives all answers that belong to the options, by question."""
    program = binary(options.no_build)
    answers = known()
    asked = questions(options)
    left = [question for question in asked if key(*question) not in answers]
    print(f"profile: {len(asked)} questions, {len(left)} of them new", flush=True)
    with open(RESULTS, "a") as file, ThreadPoolExecutor(options.jobs) as pool:
        for i, answer in enumerate(pool.map(lambda question: ask(program, question, options.seconds), left)):
            file.write(json.dumps(answer) + "\n")
            file.flush()
            answers[answer["question"]] = answer
            print(f"{i + 1}/{len(left)} {answer['question']}: {answer['status']}", flush=True)
    return {key(*question): answers[key(*question)] for question in asked if key(*question) in answers}
