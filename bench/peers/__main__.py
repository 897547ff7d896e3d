"""bench/run, once its environment is there."""

import argparse
import datetime
import json
import os
import sys
from pathlib import Path

from . import fatrop_table, robustness, table
from .check import check
from .measure import measure
from .publish import growths, publish
from .rows import all_rows
from .server import Server

HERE = Path(__file__).resolve().parent.parent


def arguments():
    parser = argparse.ArgumentParser(prog="bench/run", description="Compares ntg with CasADi + IPOPT, FATROP, sqpmethod and ripopt.")
    parser.add_argument("--only", default="", help="rows whose names begin so, e.g. B1 or vdp,car,B1/l=")
    parser.add_argument("--by", default="ntg,ipopt,fatrop,sqp,ripopt,control", help="which solvers (default: all six)")
    parser.add_argument("--repeat", type=int, default=7, help="how often the solvers take turns (default 7)")
    parser.add_argument("--seconds", type=float, default=0.05, help="length of a turn, at least one solve (default 0.05)")
    parser.add_argument("--solves", type=int, default=50, help="most solves of a turn (default 50)")
    parser.add_argument("--skip-compiled", action="store_true", help="leave out the variants that gcc has to compile")
    parser.add_argument("--scalar", action="store_true", help="also compile each whole program as one expression: minutes each")
    parser.add_argument("--check", action="store_true", help="only hold the programs against ntg's and the known optima")
    parser.add_argument("--robustness", action="store_true", help="from 50 routes instead; --only B1/l=8 and so on")
    parser.add_argument("--publish", action="store_true", help="also write results.json and docs/performance.md")
    parser.add_argument("--list", action="store_true", help="print the names of the rows")
    options = parser.parse_args()
    options.only = [word for word in options.only.split(",") if word]
    options.by = options.by.split(",")
    return options


def machine():
    cpu = [line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")]
    load = os.getloadavg()[0]
    return {"cpu": cpu[0] if cpu else "unknown", "cores": os.cpu_count(), "load": round(load, 1), "date": f"{datetime.date.today()}"}


def run_check(rows, server):
    wrong = 0
    for row in rows:
        found = check(row, server)
        wrong += bool(found)
        print(f"{row.name:<12} {'; '.join(found) or 'the same program, the known optimum'}", flush=True)
    return 1 if wrong else 0


def main():
    options = arguments()
    rows = [row for row in all_rows() if row.chosen(options.only)]
    if options.list:
        print("\n".join(row.name for row in rows))
        return
    server = Server()
    if options.check:
        return run_check(rows, server)
    if options.robustness:
        found = {"machine": machine(), "options": vars(options), "routes": robustness.run(server, options)}
        (HERE / "latest_robustness.json").write_text(json.dumps(found, indent=1))
        if options.publish:
            publish(found)
        return
    found = {"machine": machine(), "options": vars(options), "rows": {}}
    print(table.HEAD, flush=True)
    for row in rows:
        program = row.program()
        variables, result = program.variables, measure(row, program, server, options)
        found["rows"][row.name] = {"variables": variables, "solvers": result}
        print(table.line(row, variables, result), flush=True)
        for note in table.notes(row, result):
            print(note, flush=True)
        (HERE / "latest.json").write_text(json.dumps(found, indent=1))
    print("\n".join([*growths(rows, found["rows"]), "", *fatrop_table.lines(rows, found["rows"])]))
    if options.publish:
        publish(found)


if __name__ == "__main__":
    sys.exit(main())
