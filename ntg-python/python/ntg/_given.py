"""What a person gives, checked where it is given: kinds of arguments, in words."""

from __future__ import annotations

import operator
from typing import Any, Iterable, Mapping, Optional


def kind(value: Any) -> str:
    """What a value is, in one word."""
    return type(value).__name__


def mapping(value: Any, what: str) -> "dict[str, Any]":
    """Names and values; none for nothing."""
    if value is None:
        return {}
    if not (isinstance(value, Mapping) or (hasattr(value, "keys") and hasattr(value, "__getitem__"))):
        raise TypeError(f"{what} are a mapping of names to values, not {kind(value)}")
    return {name: value[name] for name in value.keys()}


def names(value: Any, what: str) -> "list[str]":
    """A list of texts; a text alone is a mistake, because its letters are texts too."""
    if isinstance(value, str):
        raise TypeError(f"{what} are a list of names, not str; write [{value!r}]")
    if not isinstance(value, Iterable):
        raise TypeError(f"{what} are a list of names, not {kind(value)}")
    found = list(value)
    for one in found:
        if not isinstance(one, str):
            raise TypeError(f"{what} are a list of names, and {kind(one)} is none")
    return found


def count(value: Any, what: str, least: int) -> int:
    """A whole number that is not too small."""
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"{what} is a whole number, not {kind(value)}") from None
    if number < least:
        raise ValueError(f"{what} is at least {least}, not {number}")
    return number


def instance(value: Any, of: type, what: str) -> Any:
    """A value of a class of the package; none stays none."""
    if value is not None and not isinstance(value, of):
        given = f"the class {value.__name__} itself" if isinstance(value, type) else kind(value)
        raise TypeError(f"{what} is an ntg.{of.__name__}, not {given}")
    return value


def times(value: Any) -> Any:
    """Times in seconds as an array of any shape."""
    import numpy as np

    try:
        if np.iscomplexobj(value):
            raise TypeError
        return np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise TypeError(f"times are numbers, in seconds; {value!r} is none") from None


def core(value: Any, of: type, what: str) -> Optional[Any]:
    """What the extension module knows of a value of a class of the package."""
    return None if value is None else instance(value, of, what)._core


__all__ = ["core", "count", "instance", "kind", "mapping", "names", "times"]
