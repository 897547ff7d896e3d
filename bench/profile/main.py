"""See bench/profile/run."""

import argparse
import datetime
import json
import os
import platform
from pathlib import Path

import draw
import measure
import profiles

BENCH = Path(__file__).resolve().parent.parent
PICTURES = BENCH.parent / "docs" / "pictures"
PAGE = BENCH.parent / "docs" / "performance.md"
BEGIN = "<!-- written by bench/profile/run --publish: begin -->"
END = "<!-- written by bench/profile/run --publish: end -->"
# So many names are listed of each kind of failure in the page; the file of results has them all.
LISTED = 40


def page(found, machine):
    """The section of docs/performance.md."""
    solvers = [("ntg", "ntg"), ("ipopt", "IPOPT")]
    row = lambda name, cells: f"| {name} | " + " | ".join(str(cell) for cell in cells) + " |"
    share = lambda count: f"{count} ({100 * count / max(found['problems'], 1):.1f} %)"
    lines = [
        BEGIN,
        "",
        f"{found['problems']} problems (spec, mesh and start); `bench/profile/run --help` says what they are and what counts as solved.",
        "",
        row("", [name for _, name in solvers]),
        "|---|---|---|",
        row("solved, and confirmed by the judge", [share(found[s]["solved"]) for s, _ in solvers]),
        row("said to be solved, and not confirmed", [len(found[s]["wrong"]) for s, _ in solvers]),
        row("fewest iterations, or as few", [found[s]["best_iterations"] for s, _ in solvers]),
        row("least processor time", [found[s]["best_cpu"] for s, _ in solvers]),
        row(f"iterations over the {found['both']} that both solve", [found[s]["sum_iterations"] for s, _ in solvers]),
        row("processor seconds over the same", [f"{found[s]['sum_cpu']:.2f}" for s, _ in solvers]),
        "",
        "![Profile of iterations](pictures/profile_iterations.svg)",
        "![Profile of processor time](pictures/profile_cpu.svg)",
        "",
    ]
    if found["median_ratio"] is not None:
        most = ", ".join(f"`{problem}` {ratio:.2f}" for problem, ratio in found["largest_ratios"])
        shares = ", ".join(f"{name} {found[s]['solved'] / found['either']:.1%}" for s, name in solvers)
        lines += [f"Of the {found['either']} that either solves: {shares}; in the least processor time: {found['ntg']['best_cpu'] / found['either']:.1%} by ntg.", ""]
        above = f"above three on {found['above_three']} of {found['both']}"
        lines += [f"ntg's iterations over IPOPT's: median {found['median_ratio']:.2f}; {above}; the largest: {most}.", ""]
    for solver, name in solvers:
        for kind, words in (("wrong", "says solved, not confirmed"), ("unsolved", "unsolved")):
            names = found[solver][kind]
            more = f", and {len(names) - LISTED} more" if len(names) > LISTED else ""
            listed = ", ".join(f"`{one}`" for one in names[:LISTED]) or "none"
            lines.append(f"- {name}, {words}: {listed}{more}.")
    lines += ["", f"Measured on {machine}. ntg's time is that of a whole solve from an interpreted spec, with transcription and check; IPOPT's is that of its own call, evaluations by ntg included.", "", END]
    return "\n".join(lines)


def publish(text):
    """Puts the section in its place, or at the end where it has none yet."""
    before = PAGE.read_text()
    if BEGIN in before and END in before:
        head, rest = before.split(BEGIN, 1)
        PAGE.write_text(head + text + rest.split(END, 1)[1])
    else:
        PAGE.write_text(before.rstrip("\n") + "\n\n## Profiles over many problems\n\n" + text + "\n")


def main():
    parser = argparse.ArgumentParser(description="Performance profiles of ntg and IPOPT; bench/profile/run says more.")
    parser.add_argument("--quick", action="store_true", help="only the specs' own meshes and starts")
    parser.add_argument("--sample", action="store_true", help="five pairs of mesh and start a spec")
    parser.add_argument("--held-out", action="store_true", help="the specs of held_out/, to which nothing is fitted")
    parser.add_argument("--only", type=lambda text: text.split(","), help="names of specs, by commas")
    parser.add_argument("--seconds", type=float, default=20, help="limit of each solve")
    parser.add_argument("--jobs", type=int, default=1, help="questions at once")
    parser.add_argument("--no-build", action="store_true", help="take the binary as it was built last")
    parser.add_argument("--report", action="store_true", help="measure nothing")
    parser.add_argument("--publish", action="store_true", help="write pictures and docs/performance.md")
    options = parser.parse_args()
    if options.held_out and options.publish:
        parser.error("what is published is about specs/: --publish goes without --held-out")
    if options.held_out:
        measure.hold_out()
    answers = measure.known() if options.report else measure.measure(options)
    problems = profiles.by_problem(answers)
    found = profiles.summary(problems, measure.SOLVERS)
    load = os.getloadavg()[0]
    machine = f"{os.cpu_count()} cores ({platform.machine()}), {datetime.date.today()}, load {load:.1f}"
    kept = measure.RESULTS.parent / "results.json"
    if options.report and kept.exists():
        # That of the measurement, and not of today.
        machine = json.loads(kept.read_text())["machine"]
    text = page(found, machine)
    print(text)
    folder = PICTURES if options.publish else measure.RESULTS.parent
    for what in ("iterations", "cpu"):
        draw.draw(profiles.ratios(problems, measure.SOLVERS, what), what, folder / f"profile_{what}.svg")
    kept.write_text(json.dumps({"machine": machine, **found}, indent=1) + "\n")
    if options.publish:
        publish(text)


if __name__ == "__main__":
    main()
