"""A compiled spec."""

from __future__ import annotations

import math
import os
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Mapping, NamedTuple, Optional, Sequence, Union

from . import _given, _ntg
from ._errors import Finding, ParameterError, SpecError
from ._settings import DEFAULT, Settings, checked, watcher
from ._solution import Solution
from ._solver import Solver

if TYPE_CHECKING:
    from ._settings import ProgressArgument

    Value = Union[float, str, Sequence[Union[float, str]], Sequence[Sequence[Union[float, str]]]]
    """A number in the declared unit, a text with a unit ("240 m/s"), or a sequence of these for an array, of its rows for a
    matrix."""


class Parameter(NamedTuple):
    """A parameter of a problem."""

    name: str
    """Its name."""
    value: "float | list[float] | list[list[float]]"
    """Its value in `unit`; a list for an array, of a matrix a list of its rows."""
    unit: str
    """The declared unit; empty for a pure number."""
    doc: str
    """Its documentation in the spec."""


class Problem:
    """A compiled spec with values of its parameters. It never changes: `with_parameters` gives another one.

    Made by `ntg.load` and `ntg.loads`. It can be pickled, with the tables that its spec names.
    """

    def __init__(self, core: "_ntg.Compiled") -> None:
        if not isinstance(core, _ntg.Compiled):
            raise TypeError(f"a Problem is made by `ntg.load` and `ntg.loads`, not of {_given.kind(core)}")
        self._core = core

    @property
    def name(self) -> str:
        """The problem's name."""
        return self._core.name

    @property
    def doc(self) -> str:
        """The problem's documentation."""
        return self._core.doc

    @property
    def text(self) -> str:
        """The text of the spec."""
        return self._core.source[1]

    @property
    def objective_unit(self) -> str:
        """The unit of the objective; empty for a pure number."""
        return self._core.objective_unit

    @property
    def notes(self) -> tuple[Finding, ...]:
        """Warnings and notes of the compiler."""
        return tuple(Finding(**found) for found in self._core.notes)

    @property
    def parameters(self) -> dict[str, Parameter]:
        """The parameters by name, with their present values."""
        return {
            name: Parameter(name, _shaped(values, shape), unit, doc)
            for name, doc, unit, values, shape in self._core.parameters
        }

    def with_parameters(self, parameters: "Mapping[str, Value] | None" = None, /, **named: "Value") -> "Problem":
        """The same problem with other values of parameters.

        Values are numbers in declared units, texts with units (`"240 m/s"`), or sequences of these for arrays; one
        member of an array is set by `{"a[2]": 1.0}`.

        Raises `ParameterError` for unknown names, values that are no numbers, and units that do not fit.
        """
        return Problem(self._core.with_parameters(merged(parameters, named)))

    def solve(
        self,
        parameters: "Mapping[str, Value] | None" = None,
        /,
        *,
        settings: Settings = DEFAULT,
        guess: Optional[Solution] = None,
        progress: "ProgressArgument" = None,
        **named: "Value",
    ) -> Solution:
        """Solves the problem, from the guess of the spec or from `guess`, a solution of the same spec.

        Parameters are given as for `with_parameters`; one that is called `settings`, `guess` or `progress` goes into
        the mapping. `progress=True` shows a line of progress; a function is called with a `Progress` in every iteration,
        and stops the solve by returning `False`. Ctrl-C raises `KeyboardInterrupt`. Other threads run meanwhile.

        A solve that ends without a solution raises nothing: see `Solution.status`.

        Raises `ParameterError`, `SettingsError`, and `SetupError` where the problem makes no sense with these values.
        """
        core = self._core.with_parameters(merged(parameters, named))
        return Solution(core.solve(checked(settings), _given.core(guess, Solution, "guess"), watcher(progress)))

    def solver(
        self,
        parameters: "Mapping[str, Value] | None" = None,
        /,
        *,
        settings: Settings = DEFAULT,
        **named: "Value",
    ) -> Solver:
        """A solver that is kept and solves again and again, with other parameters or from the last solution."""
        return Solver(self._core.with_parameters(merged(parameters, named)).solver(checked(settings)))

    def solve_many(
        self,
        table: Any,
        *,
        columns: Optional[Sequence[str]] = None,
        values: Sequence[str] = (),
        settings: Settings = DEFAULT,
        jobs: int = 0,
        block: Optional[int] = None,
        progress: Any = None,
        journal: "str | os.PathLike[str] | None" = None,
        parameters: "Mapping[str, Value] | None" = None,
    ) -> Any:
        """Solves every row of a table of parameter sets, on all cores; gives a table of the same kind.

        `table` is a pandas or polars DataFrame, an Arrow table, a mapping of columns, a NumPy array with named fields,
        or one of two dimensions with `columns`. Its columns are named after parameters; cells are numbers in declared
        units or texts with units. For arrays and mappings the result is a dictionary of NumPy arrays.

        `values` adds columns, as in `ntg sweep --value`: `"final(x)"`, `"max(speed)"`, `"sensitivity(turn)"`.
        `parameters` holds for all rows. `jobs` is the number of rows at a time, 0 for one on each core.

        Rows are cut into blocks of neighbours; one row of each block is solved from the guess of the spec, the others
        from its solution. `block` is how many rows a block has, 4 to 32 where it is not given; `block=1` solves every row
        from the guess. A row does not depend on `jobs`, and on nothing
        but its own parameters and those of its block's first row; only the column `seconds` is a clock's.

        With `journal`, finished rows survive the process: the same call goes on from there, and the file stays.
        Without it Ctrl-C loses them. A row that cannot be solved says why in `status`.

        Raises `TableError` for tables that cannot be used, `ParameterError` for unknown names and values.
        """
        from . import _table

        core = self._core.with_parameters(merged(parameters, {}))
        how = _table.how(values, jobs, block)._replace(journal=None if journal is None else (Path(journal), (1, 1)))
        inputs, sets, back = _table.read(core, table, columns)
        _table.unlike(inputs, parameters)
        found = _ntg.sweep(core, inputs, sets, checked(settings), how, _table.watcher(progress))
        return back(dict(found))

    def __reduce__(self) -> Any:
        name, text = self._core.source
        return _restored, (name, text, self._core.tables, self._core.constants, self._core.state)

    def __repr__(self) -> str:
        count = len(self._core.parameters)
        return f"<ntg.Problem {self.name}: {count} parameter{'' if count == 1 else 's'}>"


def load(path: "str | os.PathLike[str]", values: "Mapping[str, Value] | None" = None, /, **named: "Value") -> Problem:
    """Compiles a spec file; tables that it names are read beside it.

    Constants and parameters are set as by `--set` of the command: `ntg.load("chain.ntg", n=50, mass="2 kg")`. Constants
    are numbers in their units or texts with units, and everything that is made of them follows.

    Raises `SpecError` with all findings of the compiler, `ParameterError` for names that are neither, and `OSError`
    where the file cannot be read.
    """
    if isinstance(path, str) and "\n" in path:
        raise ValueError("this is no path but a text of several lines; the text of a spec is compiled by `ntg.loads`")
    place = Path(path)
    try:
        text = place.read_bytes().decode("utf-8")
    except UnicodeDecodeError as error:
        raise SpecError(f"`{place}` is not UTF-8 text: {error}") from None
    return _with_values(str(path), text, (place.parent, {}), merged(values, named))


def loads(
    text: str,
    *,
    name: str = "<text>",
    folder: "str | os.PathLike[str] | None" = None,
    tables: Optional[Mapping[str, str]] = None,
    values: "Mapping[str, Value] | None" = None,
) -> Problem:
    """Compiles the text of a spec. Tables come from `tables`, texts by the paths that the spec names, or from `folder`.

    `values` sets constants and parameters, as `load` does. Raises `SpecError` with all findings of the compiler.
    """
    if not isinstance(text, str):
        raise TypeError(f"a spec is a text (str), not {_given.kind(text)}; a file is compiled by `ntg.load`")
    if "\n" not in text and text.rstrip().endswith(".ntg"):
        raise ValueError(f"`{text}` is a path and no spec; a file is compiled by `ntg.load`")
    texts = _given.mapping(tables, "tables")
    for path, one in texts.items():
        if not (isinstance(path, str) and isinstance(one, str)):
            raise TypeError(f"tables are texts by their paths; that of {path!r} is {_given.kind(one)}")
    files = (None if folder is None else Path(folder), texts)
    return _with_values(name, text, files, merged(values, {}))


def _with_values(
    name: str, text: str, files: "tuple[Optional[Path], dict[str, str]]", values: "Mapping[str, Value]"
) -> Problem:
    """Constants are set where the spec is compiled, parameters afterwards."""
    try:
        text.encode("utf-8")
    except UnicodeEncodeError as error:
        raise SpecError(f"the text of the spec is no Unicode text: {error}") from None
    known = _ntg.constants(text) if values else []
    constants = {one: _constant(one, value) for one, value in values.items() if one in known}
    others = {one: value for one, value in values.items() if one not in known}
    core = _ntg.compile(name, text, *files, constants)
    if others:
        names = [one.split("[")[0] for one in others]
        unknown = [one for one in names if one not in {parameter[0] for parameter in core.parameters}]
        if unknown and known:
            constant_names = ", ".join(f"`{one}`" for one in known)
            raise ParameterError(f"there is neither a parameter nor a constant `{unknown[0]}`; constants are {constant_names}")
        core = core.with_parameters(others)
    return Problem(core)


def _constant(name: str, value: "Value") -> str:
    """A constant as text in the language."""
    if isinstance(value, str):
        return value
    try:
        number = float(value)
    except (TypeError, ValueError):
        kind = type(value).__name__
        raise ParameterError(f'constant `{name}`: {kind} is neither a number nor a text such as "240 m/s"') from None
    if not math.isfinite(number):
        raise ParameterError(f"constant `{name}`: {number} is no finite number")
    return str(int(number)) if number.is_integer() and abs(number) < 1e15 else repr(number)


def _shaped(values: "list[float]", shape: "list[int]") -> Any:
    """A number, a list, or a list of rows."""
    if len(shape) == 2:
        return [values[first : first + shape[1]] for first in range(0, len(values), shape[1])]
    return values if shape else values[0]


def merged(parameters: "Mapping[str, Value] | None", named: "Mapping[str, Value]") -> dict[str, Any]:
    """Both ways of giving parameters; one that is given twice is a mistake."""
    if parameters is None:
        return dict(named)
    given = _given.mapping(parameters, "parameters")
    twice = [name for name in named if name in given]
    if twice:
        raise TypeError(f"parameter `{twice[0]}` is given twice")
    return {**given, **named}


def _restored(
    name: str, text: str, tables: dict[str, str], constants: dict[str, str], state: list[tuple[str, list[float]]]
) -> Problem:
    compiled = _compiled(name, text, tuple(sorted(tables.items())), tuple(sorted(constants.items())))
    return Problem(compiled.with_state(state))


@lru_cache(maxsize=8)
def _compiled(
    name: str, text: str, tables: tuple[tuple[str, str], ...], constants: tuple[tuple[str, str], ...]
) -> "_ntg.Compiled":
    """A worker gets the same problem with every batch, and compiles it once."""
    return _ntg.compile(name, text, None, dict(tables), dict(constants))
