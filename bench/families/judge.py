"""Solves a case with the command and says how its answer compares with the known one."""

import hashlib
import json
import subprocess
import time

# The best first; a report lists counts in this order.
CLASSES = ("right", "better", "accepted", "wrong", "unsolved", "time")
# The command is stopped from outside only this long after its own limit: then it has not kept that.
GRACE = 10


def sense(text):
    """1 where the spec minimises, -1 where it maximises."""
    code = "\n".join(line.split("//")[0] for line in text.splitlines())
    return -1 if "maximize " in code else 1


def end(ntg, path, limit):
    """What the command says: exit status, its JSON document, the first line of its messages, seconds."""
    begin = time.monotonic()
    command = [ntg, "solve", path, "--format", "json", "--samples", "2", "--time-limit", str(limit)]
    try:
        ran = subprocess.run(command, capture_output=True, text=True, timeout=limit + GRACE)
    except subprocess.TimeoutExpired:
        return None, {}, "did not stop at its time limit", time.monotonic() - begin
    seconds = time.monotonic() - begin
    try:
        document = json.loads(ran.stdout)
    except ValueError:
        document = {}
    said = document.get("ending") or document.get("status") or next((line for line in ran.stderr.splitlines() if line), "")
    return ran.returncode, document, said, seconds


def classify(case, status, document, said):
    """The class of an answer: one of CLASSES."""
    objective = document.get("objective")
    if status is None or said.startswith("the time limit was reached"):
        return "time"
    if case.infeasible:
        if status == 0:
            return "wrong"
        if status == 3:
            return "accepted"
        refused = status == 2 and said.startswith("error[E")
        return "right" if refused or said.startswith("infeasible") else "unsolved"
    if status == 3 and objective is not None:
        return "accepted"
    if status != 0 or objective is None:
        return "unsolved"
    miss = (objective - case.optimum) * sense(case.text)
    allowed = case.tolerance * max(abs(case.optimum), case.scale)
    return "right" if abs(miss) <= allowed else "better" if miss < 0 else "wrong"


def answer(case, family, ntg, path, limit):
    """Writes the spec, solves it, and gives what is kept of the answer."""
    path.write_text(case.text)
    status, document, said, seconds = end(ntg, path, limit)
    objective = document.get("objective")
    unit = document.get("objective_unit") or "SI"
    # A family may have computed its answer with numpy, whose numbers json does not write.
    optimum, tolerance = float(case.optimum), float(case.tolerance)
    near = objective is not None and bool(abs(objective - optimum) <= tolerance * max(abs(optimum), case.scale))
    return {
        "family": family,
        "name": case.name,
        # By which a later run knows that it has asked the same.
        "spec": hashlib.sha256(case.text.encode()).hexdigest()[:16],
        "class": classify(case, status, document, said),
        "exit": status,
        "objective": objective,
        "unit": unit,
        "optimum": None if case.infeasible else optimum,
        "tolerance": tolerance,
        "near": near and not case.infeasible,
        "iterations": document.get("iterations", 0),
        "seconds": round(seconds, 3),
        "said": said,
        "why": case.why,
    }
