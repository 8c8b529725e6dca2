"""The errors of trainsafe."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace


@dataclass(frozen=True)
class Problem:
    """One thing that is wrong with an input, and what would be right."""

    path: str
    """The file that it is in; ``<dict>`` and ``<table>`` for what came from Python."""
    message: str
    help: str | None = None
    line: int | None = None
    column: int | None = None
    span: tuple[int, int] | None = None
    """First byte in the text and the one after the last."""
    key: str | None = None
    """Path of the key, such as ``vehicle[1].mass``, counted from 0."""
    related: tuple[str, ...] = field(default=())
    """Other places that have a part in it, in words."""


class TrainsafeError(ValueError):
    """Any error of trainsafe; ``problems`` is empty where no place in an input is wrong."""

    problems: list[Problem]

    def __init__(self, text: str, problems: Iterable[Problem] = ()) -> None:
        super().__init__(text)
        self.problems = list(problems)

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (str(self), self.problems)

    def with_names(self, names: Mapping[str, str]) -> TrainsafeError:
        """The same with other names in the place of files' paths."""
        problems = [replace(problem, path=names.get(problem.path, problem.path)) for problem in self.problems]
        return type(self)(with_names(str(self), names), problems)


class InputError(TrainsafeError):
    """A train, table or study that is wrong; ``problems`` tells each place and what would be right.

    >>> import trainsafe
    >>> try:
    ...     trainsafe.read("trains/ore-train.toml").replace("coupler.stiffness", "30 MN")
    ... except ValueError as error:
    ...     [(p.key, p.message) for p in error.problems]
    [('coupler.stiffness', 'stiffness has "MN", a unit of force')]
    """


class AnalysisError(TrainsafeError):
    """An analysis that could not be done."""


def with_names(text: str, names: Mapping[str, str]) -> str:
    """A text with other names in the place of files' paths."""
    for path, name in names.items():
        text = text.replace(path, name)
    return text


def input_error(text: str, problems: str) -> InputError:
    def problem(found: dict) -> Problem:
        found["span"] = tuple(found["span"]) if "span" in found else None
        found["related"] = tuple(f"line {r['line']}: {r['message']}" for r in found["related"])
        return Problem(**found)

    return InputError(text, [problem(found) for found in json.loads(problems)])


def analysis_error(text: str) -> AnalysisError:
    return AnalysisError(text)
