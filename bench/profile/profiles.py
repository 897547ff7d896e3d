"""Dolan and Moré's profiles: for each solver the share of problems that it solves within a factor of the best."""

import math

# What a judge outside the solvers takes for a solution: relative violation, stationarity and complementarity.
TOLERANCE = 1e-6


def is_right(answer):
    """Whether the judge confirms the point."""
    judged = answer.get("judged") or {}
    errors = [judged.get(name) for name in ("violation", "stationarity", "complementarity")]
    return all(error is not None and error <= TOLERANCE for error in errors)


def by_problem(answers):
    """problem -> solver -> answer."""
    problems = {}
    for question, answer in answers.items():
        problem, solver = question.rsplit(" ", 1)
        problems.setdefault(problem, {})[solver] = answer
    return {problem: found for problem, found in problems.items() if len(found) > 1}


def costs(problems, solver, what):
    """What each problem costs a solver; infinite where it does not solve it."""
    def cost(found):
        answer = found[solver]
        if not (answer.get("solved") and is_right(answer)):
            return math.inf
        # An iteration at least, and no time is shorter than a clock can tell.
        return max(float(answer[what]), 1.0 if what == "iterations" else 1e-4)

    return {problem: cost(found) for problem, found in problems.items()}


def ratios(problems, solvers, what):
    """solver -> the ratio of its cost to the best, for every problem that anyone solves, increasing."""
    table = {solver: costs(problems, solver, what) for solver in solvers}
    found = {solver: [] for solver in solvers}
    for problem in problems:
        best = min(table[solver][problem] for solver in solvers)
        if math.isfinite(best):
            for solver in solvers:
                found[solver].append(table[solver][problem] / best)
    return {solver: sorted(all_of) for solver, all_of in found.items()}


def summary(problems, solvers):
    """Shares and names, as data."""
    count = len(problems)
    found = {"problems": count}
    for solver in solvers:
        said = {p for p, all_of in problems.items() if all_of[solver].get("solved")}
        right = {p for p in said if is_right(problems[p][solver])}
        found[solver] = {
            "solved": len(right),
            "wrong": sorted(said - right),
            "unsolved": sorted(set(problems) - said),
        }
    for what in ("iterations", "cpu"):
        for solver, all_of in ratios(problems, solvers, what).items():
            best = sum(1 for ratio in all_of if ratio <= 1.0)
            found[solver][f"best_{what}"] = best
    both = [p for p in problems if all(problems[p][s].get("solved") and is_right(problems[p][s]) for s in solvers)]
    found["both"] = len(both)
    for solver in solvers:
        for what in ("iterations", "cpu"):
            found[solver][f"sum_{what}"] = sum(problems[p][solver][what] for p in both)
    quotients = sorted(
        (max(problems[p]["ntg"]["iterations"], 1) / max(problems[p]["ipopt"]["iterations"], 1), p) for p in both
    )
    found["median_ratio"] = quotients[len(quotients) // 2][0] if quotients else None
    found["above_three"] = sum(1 for ratio, _ in quotients if ratio > 3.0)
    found["either"] = sum(1 for p in problems if any(problems[p][s].get("solved") and is_right(problems[p][s]) for s in solvers))
    found["largest_ratios"] = [(p, ratio) for ratio, p in quotients[:-6:-1]]
    return found
