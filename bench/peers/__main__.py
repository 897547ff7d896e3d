"""bench/run, once its environment is there."""

import argparse
import datetime
import json
import os
import sys
from pathlib import Path

from . import table
from .measure import measure
from .rows import all_rows
from .server import Server

HERE = Path(__file__).resolve().parent.parent


def arguments():
    parser = argparse.ArgumentParser(prog="bench/run", description="Compares ntg with CasADi + IPOPT, sqpmethod and ripopt.")
    parser.add_argument("--only", default="", help="rows whose names begin so, e.g. B1 or vdp,car,B1/l=")
    parser.add_argument("--by", default="ntg,ipopt,sqp,ripopt", help="which solvers (default: all four)")
    parser.add_argument("--repeat", type=int, default=7, help="how often the solvers take turns (default 7)")
    parser.add_argument("--seconds", type=float, default=0.05, help="length of a turn, at least one solve (default 0.05)")
    parser.add_argument("--solves", type=int, default=50, help="most solves of a turn (default 50)")
    parser.add_argument("--skip-compiled", action="store_true", help="leave out the variants that gcc has to compile")
    parser.add_argument("--list", action="store_true", help="print the names of the rows")
    options = parser.parse_args()
    options.only = [word for word in options.only.split(",") if word]
    options.by = options.by.split(",")
    return options


def machine():
    cpu = [line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")]
    load = os.getloadavg()[0]
    return {"cpu": cpu[0] if cpu else "unknown", "cores": os.cpu_count(), "load": round(load, 1), "date": f"{datetime.date.today()}"}


def main():
    options = arguments()
    rows = [row for row in all_rows() if row.chosen(options.only)]
    if options.list:
        print("\n".join(row.name for row in rows))
        return
    server = Server()
    found = {"machine": machine(), "options": vars(options), "rows": {}}
    print(table.HEAD, flush=True)
    for row in rows:
        variables = server.ask("start", row.ask)[0]["variables"]
        result = measure(row, server, options)
        found["rows"][row.name] = {"variables": variables, "solvers": result}
        print(table.line(row, variables, result), flush=True)
        (HERE / "latest.json").write_text(json.dumps(found, indent=1))
    for solver in ("ntg", "mc", "sx", "ripopt"):
        exponent = table.growth(rows, found["rows"], solver)
        if exponent is not None:
            print(f"{solver}: time grows as l^{exponent:.2f}")


if __name__ == "__main__":
    sys.exit(main())
