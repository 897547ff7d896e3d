"""The table of results, and what it says of every row."""

import math

AGREES = 1e-6
FATROP = {"fatrop_sx": "FATROP, SX", "fatrop_c": "FATROP, C", "fatrop_mc": "FATROP, mapped C"}
IPOPT = {"sx": "SX", "mx": "MX", "c": "C", "mc": "mapped C"}


def best_ipopt(result):
    """The name of the fastest variant that solved the row."""
    found = [name for name in IPOPT if result.get(name, {}).get("solved")]
    return min(found, key=lambda name: result[name]["cpu"], default=None)


def milliseconds(answer):
    if answer is None or "cpu" not in answer:
        return "–"
    text = f"{1e3 * answer['cpu']:.3g}"
    return text if answer["solved"] else f"{text} (not solved)"


def ratio(result, peer):
    """How many times slower the peer is; none where one of them did not solve the row."""
    ours, theirs = result.get("ntg", {}), result.get(peer, {}) if peer else {}
    if not (ours.get("solved") and theirs.get("solved")):
        return None
    return theirs["cpu"] / ours["cpu"]


def against(value, target):
    if value is None:
        return "–"
    return f"{value:.3g}" + (f" / {target:g}" if target else "")


def agreement(row, result):
    """Whether all that solved the row found one objective, and the known one."""
    found = {name: answer["objective"] for name, answer in result.items() if answer.get("solved")}
    if not found:
        return "nobody solved it"
    reference = row.reference if row.reference is not None else found.get("ntg", next(iter(found.values())))
    off = {name: value / reference - 1 for name, value in found.items() if abs(value / reference - 1) > AGREES}
    return "yes" if not off else ", ".join(f"{name} {value:+.1e}" for name, value in off.items())


HEAD = (
    "| problem | n | ntg | its | CasADi + IPOPT | its | ratio / target | without check | sqpmethod | ratio / target "
    "| ripopt | its | ratio / target | ntg once | one objective |\n" + "|---" * 15 + "|"
)


def line(row, variables, result):
    ours, name = result.get("ntg"), best_ipopt(result)
    theirs = result.get(name)
    ratios = [ratio(result, peer) for peer in (name, "sqp", "ripopt")]
    alone = ratios[0] / (1 - ours["shares"]["report"]) if ratios[0] else None
    cells = [
        row.name,
        str(variables),
        milliseconds(ours),
        str(ours.get("iterations", "–")) if ours else "–",
        f"{milliseconds(theirs)} {IPOPT.get(name, '')}".strip(),
        str(theirs["iterations"]) if theirs else "–",
        against(ratios[0], row.ipopt),
        against(alone, 0),
        milliseconds(result.get("sqp")),
        against(ratios[1], row.sqp if row.sqp > 1 else 0),
        milliseconds(result.get("ripopt")),
        str(result.get("ripopt", {}).get("iterations", "–")),
        against(ratios[2], row.ripopt),
        f"{1e3 * ours['once']:.3g}" if ours and ours.get("once") else "–",
        agreement(row, result),
    ]
    return "| " + " | ".join(cells) + " |"


PARTS_HEAD = "| problem | ntg's solver | check and report | ripopt's evaluations | solver |\n|---|---|---|---|---|"


def parts(row, result):
    """Where the time goes in the two solvers that run ntg's own functions."""
    ours, theirs = (result.get(name, {}).get("shares", {}) for name in ("ntg", "ripopt"))
    shares = [ours.get(name) for name in ("solver", "report")]
    shares += [theirs.get(name) for name in ("evaluation", "solver")]
    return f"| {row.name} | " + " | ".join("–" if s is None else f"{100 * s:.0f} %" for s in shares) + " |"


def notes(row, result):
    """Lines below the table: what python-control takes, and why a solver found nothing."""
    if result.get("control", {}).get("solved"):
        times = ratio(result, "control")
        beside = f", {times:.3g} times ntg's time" if times else ""
        yield f"{row.name}: python-control takes {milliseconds(result['control'])} ms{beside}."
    for name, answer in result.items():
        if not answer["solved"]:
            yield f"{row.name}: {IPOPT.get(name) or FATROP.get(name) or name} ends with “{answer['status']}”."


def growth(rows, results, solver):
    """The exponent of time over intervals from B1/l=..., by least squares in logarithms; none for fewer than three."""
    points = []
    for row in rows:
        solvers = results.get(row.name, {}).get("solvers", {})
        answer = solvers.get(best_ipopt(solvers) if solver == "ipopt" else solver)
        if row.name.startswith("B1/l=") and answer and answer.get("solved"):
            points.append((math.log(int(row.name[5:])), math.log(answer["cpu"])))
    if len(points) < 3:
        return None
    mean_x, mean_y = (sum(p[i] for p in points) / len(points) for i in (0, 1))
    return sum((x - mean_x) * (y - mean_y) for x, y in points) / sum((x - mean_x) ** 2 for x, y in points)
