"""What can go wrong, with the compiler's findings."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple, Sequence

if TYPE_CHECKING:
    from ._solution import Solution


class Finding(NamedTuple):
    """Something the compiler has to say about a spec."""

    code: str
    """Its code, such as `E041`; `ntg explain E041` says more."""
    severity: str
    """`error`, `warning` or `note`."""
    message: str
    """What was found."""
    help: str
    """What to write instead; empty where there is nothing to say."""
    line: int
    """The line, from 1."""
    column: int
    """The column in characters, from 1."""
    end_line: int
    """The line of the end."""
    end_column: int
    """The column after the last character."""
    rendered: str
    """The finding with a picture of its place."""

    def __str__(self) -> str:
        return self.rendered


class Error(Exception):
    """Anything that ntg refuses."""

    findings: tuple[Finding, ...]
    """What the compiler found; empty where a spec is not to blame."""

    def __init__(self, message: str = "", findings: Sequence[dict[str, Any]] = ()) -> None:
        super().__init__(message)
        self.findings = tuple(Finding(**found) for found in findings)

    def __reduce__(self) -> Any:
        # Exceptions cross processes.
        return type(self), (self.args[0], [found._asdict() for found in self.findings])


class SpecError(Error, ValueError):
    """The spec has errors: all of them are in `findings`."""


class SetupError(Error, ValueError):
    """The spec is well formed, but not with these values of its parameters."""


class ParameterError(Error, ValueError):
    """An unknown name, a value that is no number, a unit that does not fit, an unknown wanted value."""


class SettingsError(Error, ValueError):
    """A setting out of its range."""


class TableError(Error, ValueError):
    """A table of parameter sets that cannot be used."""


class SensitivityError(Error, RuntimeError):
    """A solution that cannot be differentiated."""


class BusyError(Error, RuntimeError):
    """A solver is used by two threads at once."""


class UnsolvedError(Error, RuntimeError):
    """A solve ended without a solution; raised only where that was asked for."""

    solution: "Solution | None"
    """The last point, with everything that is known about it."""

    def __init__(
        self, message: str = "", findings: Sequence[dict[str, Any]] = (), solution: "Solution | None" = None
    ) -> None:
        super().__init__(message, findings)
        self.solution = solution
