"""Solvers on one row, by turns, several times."""

import statistics

from . import fatrop_solver
from .casadi_solvers import CLOCKS, Solver
from .control_solver import LaneChange
from .judge import Judge
from .server import Asked


def solvers(row, program, server, options):
    """Every solver of a row that the options ask for, by name."""
    found = {}
    if "ntg" in options.by:
        found["ntg"] = Asked(server, "ntg", row.ask)
    if "ripopt" in options.by:
        found["ripopt"] = Asked(server, "ripopt", row.ask)
    if "ipopt" in options.by:
        scaled = better_scaling(program)
        for kind in ipopt_kinds(row, options):
            found[kind] = Solver(program, kind, scaled)
    if "sqp" in options.by and row.sqp:
        found["sqp"] = Solver(program, "sqp", better_scaling(program))
    if "fatrop" in options.by:
        found |= fatrops(program, list(ipopt_kinds(row, options)))
    if "control" in options.by and row.control:
        found["control"] = LaneChange()
    return found


class Refused:
    """A solver that cannot be had for a row; its answer is why."""

    def __init__(self, error):
        self.error = error

    def answer(self, seconds, solves):
        raise self.error


def fatrops(program, kinds):
    """FATROP's variants, all in the units and at the tolerance that suit it best."""
    try:
        scaled, tolerance = fatrop_solver.best(program)
        # Compiled code rounds otherwise, so each variant must first show that it comes back.
        tried = [kind for kind in kinds if kind == "sx" or fatrop_solver.attempt(program, kind, scaled, tolerance)["solved"]]
        return {f"fatrop_{kind}": fatrop_solver.Fatrop(program, kind, scaled, tolerance) for kind in tried}
    except RuntimeError as error:
        return {"fatrop_sx": Refused(error)}


def ipopt_kinds(row, options):
    yield "sx"
    if not options.skip_compiled:
        yield "mc"
        if row.scalar or options.scalar:
            yield "c"


def better_scaling(program):
    """Whether IPOPT needs fewer iterations in variables of size 1 than in kilometres and seconds."""
    plain, scaled = (Solver(program, "sx", scaled).once() for scaled in (False, True))
    if plain["solved"] != scaled["solved"]:
        return scaled["solved"]
    return scaled["iterations"] < plain["iterations"]


def measure(row, program, server, options):
    """Everything known about a row: for each solver its answer, and medians of batches in seconds."""
    asked = solvers(row, program, server, options)
    answers, batches = {}, {name: {clock: [] for clock in CLOCKS} for name in asked}
    shares = {name: [] for name in asked}
    for _ in range(options.repeat):
        for name, solver in list(asked.items()):
            try:
                answer = solver.answer(options.seconds, options.solves)
            except RuntimeError as error:
                # Some solvers end in an error; that is their answer to this row.
                answers[name] = {"solved": False, "status": str(error).strip().splitlines()[-1]}
                del asked[name]
                continue
            answers[name] = answer
            shares[name].append(parts_of_a_whole(answer))
            for clock in set(CLOCKS) & set(answer):
                batches[name][clock].append(statistics.median(answer[clock]))
    judge_all(program, asked, answers)
    return {name: summary(answer, batches[name], shares[name]) for name, answer in answers.items()}


def judge_all(program, asked, answers):
    """Adds the errors of the point where each solver ended, if it says where, by one judge."""
    told = [name for name, solver in asked.items() if hasattr(solver, "end")]
    judge = Judge(program) if told else None
    for name in told:
        answers[name]["judged"] = judge.errors(*asked[name].end)


def parts_of_a_whole(answer):
    """What share of a solve each of its parts takes, where the solver says so."""
    parts = answer.get("parts") or {}
    whole = sum(parts.values())
    return {name: value / whole for name, value in parts.items()} if whole else {}


def summary(answer, batches, shares):
    kept = {key: value for key, value in answer.items() if key not in CLOCKS}
    for clock, values in batches.items():
        if values:
            kept[clock] = statistics.median(values)
            kept[clock + "_batches"] = values
    kept.pop("parts", None)
    kept["shares"] = {name: statistics.median(share[name] for share in shares) for name in (shares or [{}])[0]}
    return kept
