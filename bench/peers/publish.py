"""Writes what was measured to bench/results.json and to the section of docs/performance.md that it owns."""

import json
from pathlib import Path

from . import fatrop_table, table
from .rows import all_rows

HERE = Path(__file__).resolve().parent.parent
RESULTS = HERE / "results.json"
PAGE = HERE.parent / "docs" / "performance.md"
BEGIN, END = "<!-- written by bench/run --publish: begin -->", "<!-- written by bench/run --publish: end -->"

TEXT = """
Median processor time in milliseconds, and how many times slower the peers are beside what ntg is meant to reach.
bench/README.md says what is timed; `bench/results.json` holds every batch, on the processor and on the wall.
Shares of a solve, and the column "without check" that follows from them, are measured on the wall within single solves: where the load is above the number of cores they are not to be relied on.
"""

CHAINS = """
FATROP on the same programs, written as chains of stages (bench/README.md). Times in milliseconds: of the call on the processor, without evaluations on the wall.
Errors are the largest of relative violation, stationarity and complementarity by a judge outside the solvers.
"""


def publish(found):
    """Rows of this run replace those of earlier ones; each keeps its machine and date. The table of FATROP has rows of its
    own, so that it can be measured without the solvers of the other one, each beside ntg in the same run."""
    known = json.loads(RESULTS.read_text()) if RESULTS.exists() else {"rows": {}, "routes": {}}
    for kind, measured in kinds(found).items():
        for name, what in measured.items():
            known.setdefault(kind, {})[name] = {"machine": found["machine"], **what}
    RESULTS.write_text(json.dumps(known, indent=1) + "\n")
    before, rest = PAGE.read_text().split(BEGIN)
    after = rest.split(END)[1]
    PAGE.write_text(before + BEGIN + "\n" + section(known) + END + after)


def kinds(found):
    """What a run replaces, by kind."""
    by = found["options"]["by"]
    rows = found.get("rows", {})
    return {
        "rows": rows if {"ipopt", "ripopt"} <= set(by) else {},
        "chains": rows if "fatrop" in by else {},
        "routes": found.get("routes", {}),
    }


def section(known):
    rows = [row for row in all_rows() if row.name in known["rows"]]
    lines = [TEXT, table.HEAD]
    lines += [table.line(row, known["rows"][row.name]["variables"], known["rows"][row.name]["solvers"]) for row in rows]
    lines.append("")
    for row in rows:
        lines += [f"- {note}" for note in table.notes(row, known["rows"][row.name]["solvers"])]
    lines += growths(rows, known["rows"])
    chains = known.get("chains", {})
    table_of_chains = fatrop_table.lines(all_rows(), chains)
    lines += [CHAINS, *table_of_chains, "", places(chains.values())] if table_of_chains else []
    lines += ["", places(known["rows"].values()), "", "Where the time goes, in the same runs:", "", table.PARTS_HEAD]
    lines += [table.parts(row, known["rows"][row.name]["solvers"]) for row in rows]
    if known["routes"]:
        from . import robustness

        lines += ["", "From the 50 random coarse routes of `specs/data/routes.csv`:", "", robustness.HEAD]
        lines += robustness.lines(known["routes"])
        lines += ["", places(known["routes"].values())]
    return "\n".join(lines) + "\n\n"


def growths(rows, results):
    found = {name: table.growth(rows, results, name) for name in ("ntg", "ipopt", "ripopt")}
    words = {"ntg": "ntg", "ipopt": "IPOPT", "ripopt": "ripopt"}
    said = [f"{words[name]} as l^{exponent:.2f}" for name, exponent in found.items() if exponent is not None]
    return [f"- Time of B1 over the number of intervals l grows: {', '.join(said)}."] if said else []


def places(measured):
    """Where and when, once for each machine."""
    seen = {}
    for one in measured:
        machine = one["machine"]
        seen.setdefault((machine["cores"], machine["cpu"], machine["date"]), []).append(machine["load"])
    words = [f"{cores} cores of an {cpu}, {date}, load {min(load)} to {max(load)}" for (cores, cpu, date), load in seen.items()]
    return "Measured on " + "; ".join(words) + "."
