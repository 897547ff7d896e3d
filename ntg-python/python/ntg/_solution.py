"""What a solve found."""

from __future__ import annotations

import html
import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any, Iterator, NamedTuple, Optional, Sequence, Union

from . import _given
from ._curve import POINTS, Curve
from ._errors import UnsolvedError
from ._sensitivity import Sensitivity
from ._settings import Progress

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    from . import _ntg
    from ._problem import Problem

class Phase(NamedTuple):
    """A phase and its times."""

    name: str
    """Its path; empty without one."""
    start: float
    """Its start in seconds."""
    end: float
    """Its end in seconds."""


class Worst(NamedTuple):
    """Where a constraint is violated most."""

    violation: float
    """By how much the nearer bound is missed, in the constraint's unit; 0 where all is met."""
    relative: float
    """The same, relative to the scale of the bounds."""
    value: float
    """The constraint's value there, in its unit."""
    time: Optional[float]
    """When, in seconds; none for a constraint at no point."""


class Constraint(NamedTuple):
    """One constraint of the spec, over all of its members and points."""

    name: str
    """Its name, or its text."""
    text: str
    """Its text in the spec."""
    line: int
    """Its line in the spec."""
    block: str
    """`initial`, `trajectory`, `final`, `temporal` or `continuity`."""
    unit: str
    """The unit of values and violations."""
    points: Optional[Worst]
    """Where it is violated most at the points of the transcription."""
    between: Optional[Worst]
    """Where it is violated most on a finer grid."""
    multiplier: Optional[float]
    """The largest multiplier: derivative of the objective by the bound, per second along a trajectory."""
    multiplier_time: Optional[float]
    """When, in seconds."""
    sensitivity: float
    """Derivative of the objective by the bound, moved everywhere at once: objective's unit per `unit`."""


class Measurement(NamedTuple):
    """One statement of `measure`."""

    name: str
    """Its name, or its text in the spec."""
    unit: str
    """The unit of its residuals."""
    chi2: float
    """Its part of chi^2."""
    share: float
    """That part of the whole, from 0 to 1."""
    indices: list[tuple[int, ...]]
    """For each measured number the indices of its loops: those of `for`, then the element of a vector."""
    residuals: list[float]
    """By how much each number is missed, in the unit."""
    ratios: list[float]
    """The same as multiples of their standard deviations."""


class Estimate(NamedTuple):
    """What the measurements of a problem say at its solution."""

    values: dict[str, float]
    """The declared variables, in their units; empty where `unknown` says why."""
    deviations: dict[str, float]
    """Their standard deviations, in the same units."""
    correlations: list[list[float]]
    """Their correlations, row by row."""
    chi2: float
    """The sum of all squared ratios of residuals to their standard deviations; about `count` where the model is right."""
    count: int
    """How many numbers were measured."""
    measurements: dict[str, Measurement]
    """The statements of `measure` by name; `name (2)` for the second of a name."""
    unknown: Optional[str]
    """Why there are no standard deviations."""


class Solution:
    """What a solve found: functions of time, numbers, checks. Where it is not solved, the last point.

    `solution["x"]` is a `Curve` for an output or named expression, a number for a time, a variable or a constant.
    """

    def __init__(self, core: "_ntg.Found") -> None:
        self._core = core
        self._page: Optional[str] = None

    def __reduce__(self) -> Any:
        raise TypeError("a Solution cannot be copied or pickled; `save` it, or take what is wanted, as `sample()`")

    # How it ended.

    @property
    def status(self) -> str:
        """Why the solve ended, in one word: `solved`, `infeasible`, `iteration_limit`, `time_limit`, `cancelled`, ..."""
        return self._core.status

    @property
    def solved(self) -> bool:
        """Whether a solution was found."""
        return self._core.is_solved

    @property
    def resolution(self) -> str | None:
        """Of a solution, whether what holds at the points of the mesh holds between them: `fine`; `coarse`, where something is missed by
        more than is worth a warning; `unresolved`, where an equation is missed by more than its largest term, a limit by
        more than half, or more than half of the objective is not seen."""
        return self._core.resolution

    @property
    def message(self) -> str:
        """Why the solve ended, in words."""
        return self._core.message

    @property
    def advice(self) -> str:
        """What to try next; empty when solved."""
        return self._core.advice

    def raise_if_unsolved(self) -> "Solution":
        """The solution itself; raises `UnsolvedError` where there is none."""
        if self.solved:
            return self
        words = f"{self.problem.name}: {self.message}"
        raise UnsolvedError(f"{words}. {self.advice}" if self.advice else words, solution=self)

    def explain(self) -> str:
        """Which constraints cannot hold together, where, and by how much; empty for a solution."""
        return self._core.explain()

    # Numbers.

    @property
    def objective(self) -> float:
        """The objective, in `objective_unit`."""
        return self._core.objective

    @property
    def objective_fine(self) -> float:
        """The objective integrated on a finer grid: closer to what flying would cost."""
        return self._core.objective_fine

    @property
    def objective_correction(self) -> float:
        """What is to be added to the objective, to first order, for what equations miss between the points."""
        return self._core.objective_correction

    @property
    def objective_unit(self) -> str:
        """The unit of the objective; empty for a pure number."""
        return self._core.objective_unit

    @property
    def terms(self) -> dict[str, float]:
        """The terms of the objective by name, each in its unit."""
        return {name: value for name, value, _ in self._core.terms}

    @property
    def violation_points(self) -> float:
        """Largest violation of a constraint at the points of the transcription, relative to its bounds."""
        return self._core.violation[0]

    @property
    def violation_between(self) -> float:
        """The same on a finer grid, between the points."""
        return self._core.violation[1]

    @property
    def iterations(self) -> int:
        """Iterations of all steps of a continuation."""
        return self._core.iterations

    @property
    def seconds(self) -> float:
        """Seconds of the solve on the clock, checks included."""
        return self._core.seconds

    @property
    def history(self) -> list[Progress]:
        """All iterations that were made."""
        return [Progress(*step) for step in self._core.history]

    @property
    def constraints(self) -> dict[str, Constraint]:
        """The constraints by name, in the order of the spec; `name (line 12)` where a name stands twice."""
        found: dict[str, Constraint] = {}
        for data in self._core.constraints:
            for part in ("points", "between"):
                data[part] = None if data[part] is None else Worst(**data[part])
            one = Constraint(**data)
            found[one.name if one.name not in found else f"{one.name} (line {one.line})"] = one
        return found

    @property
    def estimate(self) -> Optional[Estimate]:
        """What the measurements say: values and standard deviations of the variables, residuals; none without `measure`."""
        found = json.loads(self._core.estimate) if self._core.estimate is not None else None
        return None if found is None else _estimate(found)

    @property
    def problem(self) -> "Problem":
        """The problem with the parameters that were solved."""
        from ._problem import Problem

        return Problem(self._core.problem)

    # Functions of time.

    @property
    def start(self) -> float:
        """When the first agent starts, in seconds of mission time."""
        return self._core.span[0]

    @property
    def end(self) -> float:
        """When the last agent ends, in seconds of mission time."""
        return self._core.span[1]

    @property
    def duration(self) -> float:
        """From start to end, in seconds."""
        return self.end - self.start

    @property
    def phases(self) -> list[Phase]:
        """All phases of all agents, each agent's in order of time."""
        return [Phase(*phase) for phase in self._core.phases]

    @property
    def outputs(self) -> dict[str, Curve]:
        """The flat outputs by path; vectors and matrices as a whole, `outputs["r"]`."""
        return {data[0]: Curve(self._core, data) for data in self._core.outputs[1]}

    @property
    def expressions(self) -> "dict[str, Union[Curve, float, NDArray[np.float64]]]":
        """The named expressions by path: functions of time, and numbers in their units; vectors as a whole."""
        _, curves, numbers = self._core.expressions
        found: "dict[str, Union[Curve, float, NDArray[np.float64]]]" = {}
        found.update({data[0]: Curve(self._core, data) for data in curves})
        found.update(self._gathered({name: value for name, value, _ in numbers}))
        return found

    def _curves(self) -> list[Curve]:
        """Outputs and named expressions that are functions of time, element by element."""
        return [Curve(self._core, data) for data in [*self._core.outputs[0], *self._core.expressions[0]]]

    def _gathered(self, numbers: dict[str, float]) -> "dict[str, Union[float, NDArray[np.float64]]]":
        """Numbers by name, those of a vector or a matrix as one array."""
        import numpy as np

        names, values = list(numbers), np.array(list(numbers.values()))
        found: "dict[str, Union[float, NDArray[np.float64]]]" = {}
        for name, shape, first in self._core.arrays(names):
            count = int(np.prod(shape))
            found[name] = values[first : first + count].reshape(shape) if shape else float(values[first])
        return found

    @property
    def times(self) -> dict[str, float]:
        """Durations and event times in seconds, by name: `T`, `boost.burn`, `start(boost)`."""
        return dict(self._core.times)

    @property
    def variables(self) -> "dict[str, Union[float, NDArray[np.float64]]]":
        """The declared variables by name, in their units: numbers, and arrays for vectors and matrices."""
        return self._gathered({name: value for name, value, _ in self._core.variables})

    def __getitem__(self, name: str) -> "Union[Curve, float, NDArray[np.float64]]":
        """What has this name: a function of time, a number, or an array of numbers. `solution["r"]` is a vector, and
        `solution["r[1]"]` its first element."""
        if not isinstance(name, str):
            raise TypeError(f"a solution is read by name, not by {_given.kind(name)}; `solution.keys()` are the names")
        data = self._core.curve(name)
        if data is not None:
            return Curve(self._core, data)
        numbers = self._numbers()
        if name in numbers:
            return numbers[name]
        arrays = self._gathered(numbers)
        if name in arrays:
            return arrays[name]
        names = ", ".join(f"`{one}`" for one in self)
        raise KeyError(f"there is no `{name}`; there are: {names}")

    def _numbers(self) -> dict[str, float]:
        """Times, variables and named numbers, element by element."""
        own = [*self._core.variables, *self._core.expressions[2]]
        return {**self.times, **{name: value for name, value, _ in own}}

    def __contains__(self, name: object) -> bool:
        return name in set(self) or name in {curve.name for curve in self._curves()} or name in self._numbers()

    def __iter__(self) -> Iterator[str]:
        return iter(dict.fromkeys([*self.outputs, *self.expressions, *self.times, *self.variables]))

    def keys(self) -> list[str]:
        """The names that `solution[name]` takes; of a vector it takes those of the elements too, `r[1]`."""
        return list(self)

    # Derivatives.

    def sensitivity(self, *parameters: str) -> Sensitivity:
        """Derivatives by these parameters (`"v_max"`, an array `"start"` or a member `"start[2]"`), or by all.

        Raises `ParameterError` for unknown names, and `SensitivityError` where there is no solution, or where the
        conditions under which one can be differentiated do not hold.
        """
        return Sensitivity(self._core.sensitivity(_given.names(parameters, "parameters") or None))

    # Tables.

    def sample(self, times: "int | ArrayLike" = POINTS) -> "dict[str, NDArray[np.float64]]":
        """Outputs and named expressions at times in SI units, or at so many equally spaced ones; the times are `t`.

        A vector has a column for each of its elements. Where the spec has another `domain`, the times have its name and unit.
        Outside the span of an agent its columns are NaN.
        """
        import numpy as np

        if isinstance(times, (int, np.integer)):
            t = np.linspace(self.start, self.end, _given.count(times, "the number of times", 0))
        else:
            t = _given.times(times)
        if t.ndim != 1:
            raise ValueError("times are a number of them, or an array of one dimension")
        name, _, factor = self._core.independent
        table = {name: t / factor}
        for curve in self._curves():
            near = 1e-12 * max(abs(curve.start), abs(curve.end), 1.0)
            inside = (t >= curve.start - near) & (t <= curve.end + near)
            table[curve.name] = np.where(inside, curve(t), np.nan)
        return table

    @property
    def units(self) -> dict[str, str]:
        """The units of the columns of `sample` and of the tables; empty for pure numbers."""
        name, unit, _ = self._core.independent
        return {name: unit, **{curve.name: curve.unit for curve in self._curves()}}

    def to_pandas(self, times: "int | ArrayLike" = POINTS) -> Any:
        """`sample` as a pandas DataFrame; the units are in its `attrs["units"]`."""
        import pandas

        table = pandas.DataFrame(self.sample(times))
        table.attrs["units"] = self.units
        return table

    def to_polars(self, times: "int | ArrayLike" = POINTS) -> Any:
        """`sample` as a polars DataFrame."""
        import polars

        return polars.DataFrame(self.sample(times))

    def to_arrow(self, times: "int | ArrayLike" = POINTS) -> Any:
        """`sample` as an Arrow table; every field has its unit in its metadata."""
        import pyarrow

        units = self.units
        columns = self.sample(times)
        fields = [pyarrow.field(name, pyarrow.float64(), metadata={"unit": units[name]}) for name in columns]
        return pyarrow.table([pyarrow.array(values) for values in columns.values()], schema=pyarrow.schema(fields))

    # For people.

    def report(self) -> str:
        """The report in words."""
        return self._core.text()

    def html(self, tracks: Sequence[tuple[str, str]] = ()) -> str:
        """The report as one HTML page that needs no network; `tracks` are pairs of quantities to draw as maps."""
        pairs = [] if isinstance(tracks, str) else list(tracks)
        if isinstance(tracks, str) or not all(isinstance(pair, (tuple, list)) and len(pair) == 2 for pair in pairs):
            raise TypeError('tracks are pairs of names, as in [("x", "y")]')
        return self._core.html([(x, y) for x, y in pairs])

    def save(self, path: "str | os.PathLike[str]", *, overwrite: bool = False) -> None:
        """Saves as `ntg solve --save` does, for `ntg plot`, `ntg report` and `--guess`; or as HTML for `.html`.

        Raises `FileExistsError` for a file that exists, unless `overwrite` is given.
        """
        place = Path(path)
        if not place.parent.is_dir():
            raise FileNotFoundError(f"there is no folder `{place.parent}` to save `{place.name}` in")
        if place.exists() and not overwrite:
            raise FileExistsError(f"`{place}` exists; give overwrite=True to replace it, or another name")
        text = self.html() if place.suffix.lower() in (".html", ".htm") else self._core.json()
        partial = place.with_name(f".{place.name}.{os.getpid()}")
        try:
            partial.write_text(text, encoding="utf-8")
            partial.replace(place)
        finally:
            partial.unlink(missing_ok=True)

    def plot(self, *names: str, times: "int | ArrayLike" = POINTS, axes: Any = None) -> Any:
        """Draws quantities over time with matplotlib, one below the other; all outputs where none are named.

        Gives the axes. `axes` are those to draw in, as many as names.
        """
        import matplotlib.pyplot as plt
        import numpy as np

        curves = [self._curve(name) for name in names] or list(self.outputs.values())
        if axes is None:
            _, axes = plt.subplots(len(curves), 1, sharex=True, squeeze=False, layout="constrained")
        places = np.atleast_1d(axes).reshape(-1)
        name, unit, factor = self._core.independent
        for curve, place in zip(curves, places):
            t = np.linspace(curve.start, curve.end, times) if isinstance(times, int) else np.asarray(times, float)
            values = curve(t).reshape(len(t), -1)
            lines = place.plot(t / factor, values)
            if curve.shape:
                place.legend(lines, curve.elements)
            place.set_ylabel(f"{curve.name} [{curve.unit}]" if curve.unit else curve.name)
            place.margins(x=0)
            place.grid(alpha=0.3)
        places[-1].set_xlabel(f"{name} [{unit}]" if unit else name)
        return axes

    def plot_track(self, x: str, y: str, times: int = POINTS, axes: Any = None) -> Any:
        """Draws one quantity over another with matplotlib, in equal scales where their units are the same."""
        import matplotlib.pyplot as plt
        import numpy as np

        across, up = self._curve(x), self._curve(y)
        for curve in (across, up):
            if curve.shape:
                raise ValueError(f"`{curve.name}` is a vector: name one of its elements, `{curve.elements[0]}`")
        place = axes if axes is not None else plt.subplots(layout="constrained")[1]
        t = np.linspace(across.start, across.end, times)
        (line,) = place.plot(across(t), up(t))
        place.plot(*[[curve(curve.start)] for curve in (across, up)], "o", color=line.get_color())
        for curve, label in ((across, place.set_xlabel), (up, place.set_ylabel)):
            label(f"{curve.name} [{curve.unit}]" if curve.unit else curve.name)
        if across.unit == up.unit:
            place.set_aspect("equal", adjustable="datalim")
        place.grid(alpha=0.3)
        return place

    def _curve(self, name: str) -> Curve:
        found = self[name]
        if isinstance(found, Curve):
            return found
        raise ValueError(f"`{name}` is a number, not a function of time")

    def __repr__(self) -> str:
        unit = f" {self.objective_unit}" if self.objective_unit else ""
        return f"<ntg.Solution of {self.problem.name}: {self.status}, objective {self.objective:.9g}{unit}>"

    def _repr_html_(self) -> str:
        if self._page is None:
            self._page = self.html()
        return (
            f'<iframe srcdoc="{html.escape(self._page, quote=True)}" title="report of {html.escape(self.problem.name)}" '
            'style="width: 100%; height: 720px; border: 1px solid #8884; border-radius: 4px; box-sizing: border-box" '
            'loading="lazy"></iframe>'
        )


def _estimate(found: dict[str, Any]) -> Estimate:
    """From the fields of docs/solution-format.md."""
    measurements: dict[str, Measurement] = {}
    for one in found["measurements"]:
        residuals = one["residuals"]
        same = sum(1 for other in measurements.values() if other.name == one["name"])
        measurements[one["name"] if same == 0 else f"{one['name']} ({same + 1})"] = Measurement(
            name=one["name"],
            unit=one["unit"],
            chi2=one["chi2"],
            share=one["share"],
            indices=[tuple(residual["indices"]) for residual in residuals],
            residuals=[residual["value"] for residual in residuals],
            ratios=[residual["ratio"] for residual in residuals],
        )
    return Estimate(
        values={name: one["value"] for name, one in found["deviations"].items()},
        deviations={name: one["sigma"] for name, one in found["deviations"].items()},
        correlations=found["correlations"],
        chi2=found["chi2"],
        count=found["count"],
        measurements=measurements,
        unknown=found["unknown"],
    )
