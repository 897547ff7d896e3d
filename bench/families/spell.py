"""How what is drawn is spelled in a spec: numbers, bounds, guesses, objectives, blocks, whole problems."""

import math


def number(value):
    """A number as specs write it, with a digit on both sides of the point, without the last digits of its rounding."""
    short = float(f"{value:.12g}")
    value = short if abs(value - short) <= 1e-15 * abs(value) else float(value)
    return repr(int(value)) if value == int(value) and abs(value) < 1e6 else repr(value)


def numbers(values):
    """A list of numbers, or of such lists."""
    spelled = [numbers(one) if hasattr(one, "__len__") else number(one) for one in values]
    return f"({spelled[0]},)" if len(spelled) == 1 else f"({', '.join(spelled)})"


def rounded(value, digits):
    return float(f"{value:.{digits - 1}e}")


def log_uniform(rng, low, high):
    return math.exp(rng.uniform(math.log(low), math.log(high)))


def draw(rng, low, high, digits=3):
    """A number of few digits, evenly on a logarithmic scale."""
    return rounded(log_uniform(rng, low, high), digits)


def bounds(rng, value, symbol=""):
    """Bounds of a duration, or of what else is sought, of about `value` in a unit: from narrow to none at all."""
    low = lambda factor: number(rounded(factor * value, 2))
    mark = f" [{symbol}]" if symbol else ""
    return rng.choice((
        f"0{mark} ..",
        f"{low(1e-3)}{mark} ..",
        f"0 .. {low(1e3)}{mark}",
        f"{low(0.01)} .. {low(100)}{mark}",
        f"{low(0.3)} .. {low(5)}{mark}",
    ))


def objective(rng, sense, name, expression, symbol, si):
    """An objective that is shown in its unit or in SI units, and by what a value in its unit is multiplied to be shown."""
    if symbol and rng.random() < 0.6:
        return f"{sense} {name} [{symbol}]: {expression};", 1.0
    return f"{sense} {expression};", si


def guess(rng, line, poor):
    """The `guess` block: none at all, a line, or a poor one; each a list of `name = value;` without a semicolon."""
    lines = rng.choice(([], line, poor))
    return [block("guess", lines)] if lines else []


def block(kind, statements):
    """`kind { a;  b; }`, or a statement a line where that is too long."""
    text = f"{kind} {{ " + "  ".join(f"{one};" for one in statements) + " }"
    return text if len(text) <= 110 else f"{kind} {{\n" + "".join(f"    {one};\n" for one in statements) + "}"


def shuffled(rng, items):
    items = list(items)
    rng.shuffle(items)
    return items


def problem(rng, title, doc, statements):
    """A spec of statements, without those that are empty; their order means nothing, it is drawn in half of the specs."""
    statements = [one for one in statements if one]
    if rng.random() < 0.5:
        statements = shuffled(rng, statements)
    body = "".join(f"    {line}\n" for one in statements for line in one.splitlines())
    return f"/// {doc}\nproblem {title} {{\n{body}}}\n"
