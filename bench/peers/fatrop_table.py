"""The table of FATROP on the chain forms of the same programs, and how many rows meet the targets."""

from . import table

WHOLE, ALONE, ROWS = 10, 3, 30  # Times that ntg should be faster: the call, and without evaluations; on how many rows.
HEAD = (
    "| problem | stages | largest | ntg | FATROP | its | ratio / target | without evaluations | ratio / target "
    "| tolerance | FATROP's error | IPOPT's error |\n" + "|---" * 12 + "|"
)


def variant(result):
    """The name of the fastest variant that solved the row; they share units and tolerance."""
    named = [name for name in table.FATROP if name in result]
    solved = [name for name in named if result[name]["solved"]]
    return min(solved, key=lambda name: result[name]["cpu"]) if solved else next(iter(named), None)


def ratios(result):
    """How many times slower than ntg: the whole, and without evaluations; none where one did not solve the row."""
    name = variant(result)
    whole = table.ratio(result, name)
    return (None, None) if whole is None else (whole, result[name]["alone"] / result["ntg"]["cpu"])


def error(answer):
    """The largest of the judge's three."""
    judged = (answer or {}).get("judged")
    return f"{max(judged.values()):.0e}" if judged else "–"


def line(row, result):
    name = variant(result)
    theirs, shape = result[name], result[name].get("chain", {})
    whole, alone = ratios(result)
    words = [table.milliseconds(theirs), table.FATROP[name].split(", ")[1]]
    cells = [
        row.name,
        str(shape.get("stages", "–")),
        str(shape.get("largest", "–")),
        table.milliseconds(result.get("ntg")),
        " ".join(words),
        str(theirs.get("iterations", "–")),
        table.against(whole, WHOLE),
        f"{1e3 * theirs['alone']:.3g}" if "alone" in theirs else "–",
        table.against(alone, ALONE),
        f"{theirs['tolerance']:.0e}" if theirs["solved"] else "none",
        error(theirs),
        error(result.get(table.best_ipopt(result))),
    ]
    return "| " + " | ".join(cells) + " |"


def lines(rows, results):
    """The table of the rows that FATROP was asked, and the count; nothing if there are none."""
    asked = [(row, results[row.name]["solvers"]) for row in rows if row.name in results]
    asked = [(row, result) for row, result in asked if variant(result)]
    if not asked:
        return []
    found = [ratios(result) for _, result in asked]
    fast = sum(whole is not None and whole >= WHOLE for whole, _ in found)
    faster = sum(alone is not None and alone >= ALONE for _, alone in found)
    tight = sum(result[variant(result)]["solved"] and result[variant(result)]["tolerance"] <= 1e-8 for _, result in asked)
    count = (
        f"- FATROP, {len(asked)} rows: ntg is {WHOLE} times faster than the whole call on {fast}, {ALONE} times faster than"
        f" FATROP without evaluations on {faster} (target: {ROWS}). FATROP ends with a tolerance of 1e-8 on {tight}."
    )
    return [HEAD, *(line(row, result) for row, result in asked), "", count]
