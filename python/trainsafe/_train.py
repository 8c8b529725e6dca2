"""Trains."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any, NamedTuple

from . import _native, _toml
from ._table import Table


class Doubt(NamedTuple):
    """Something that is probably not meant."""

    code: str
    """A stable word for programs, such as ``no-load``."""
    scenario: str | None
    text: str


class Train:
    """A train and what is to happen to it; it is valid by construction.

    >>> import trainsafe
    >>> train = trainsafe.read("trains/ore-train.toml")
    >>> len(train)
    105
    >>> stiffer = train.replace("coupler.stiffness", "60 MN/m")
    >>> stiffer.vehicles.to_dict()["stiffness_n_per_m"][0]
    60000000.0
    """

    def __init__(self, document: _native.Document) -> None:
        self._document = document

    @staticmethod
    def from_text(text: str, path: str | os.PathLike[str] = "<text>") -> Train:
        """The train of a train file's text; files that it names stand beside `path`."""
        return Train(_native.Document.of_text(text, os.fspath(path), []))

    @staticmethod
    def from_dict(data: Mapping[str, Any], path: str | os.PathLike[str] = "<dict>") -> Train:
        """The train of a dictionary with the keys of a train file. Quantities are strings with their units, or `pint` quantities.

        >>> import trainsafe
        >>> train = trainsafe.Train.from_dict({
        ...     "coupler": {"stiffness": "30 MN/m", "rated_load": "1.5 MN"},
        ...     "vehicle": [{"label": "car", "count": 3, "mass": "80 t"}],
        ...     "load": {"uniform": "40 %"},
        ... })
        >>> train.vehicles.to_dict()["initial_force_n"]
        [600000.0, 600000.0, None]
        """
        return Train(_native.Document.of_text(_toml.document(data), os.fspath(path), []))

    @staticmethod
    def from_table(table: Any, /, **keys: Any) -> Train:
        """The train whose vehicles are the rows of a table: of pandas, polars, DuckDB, pyarrow, or anything with `__arrow_c_stream__`.

        Columns are headed as those of a CSV table of vehicles (`mass [t]`, `label`, `rated_load [MN]`, ...); the other keys of a train
        file are given by name: `coupler={...}`, `load={...}`, `scenario=[...]`. `coupler` is needed even where the table has columns
        of every coupler, which go before it.
        """
        if not hasattr(table, "__arrow_c_stream__"):
            table = _by_arrow(table)
        text = _native.csv_text(table.__arrow_c_stream__())
        text_of_train = _toml.document({"vehicles": "<table>", **keys})
        held = [("<table>", _digest(text), text)]
        return Train(_native.Document.of_text(text_of_train, "<keys>", held))

    def replace(self, key: str, value: Any) -> Train:
        """The same train with another value of a key, such as `coupler.stiffness`, `load.uniform` or `vehicle[0].mass`, counted from 0
        as in a study."""
        return Train(self._document.replace(key, _toml.value(value)))

    @property
    def name(self) -> str:
        return self._document.name

    @property
    def scenarios(self) -> list[str]:
        """Names of the scenarios."""
        return self._document.scenarios

    @property
    def vehicles(self) -> Table:
        """A row for each vehicle, with the coupler behind it."""
        return Table(self._document.vehicles())

    @property
    def doubts(self) -> list[Doubt]:
        """What is probably not meant, as `trainsafe check` tells it."""
        return [Doubt(*doubt) for doubt in self._document.doubts]

    @property
    def text(self) -> str:
        """The text of the train file."""
        return self._document.text

    def describe(self) -> str:
        """What the train is and what will be run, as `trainsafe check` prints it."""
        return self._document.describe()

    def __len__(self) -> int:
        return len(self._document)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Train) and self._state() == other._state()

    def __hash__(self) -> int:
        return hash((self.text, os.fspath(self._document.path)))

    def __repr__(self) -> str:
        scenarios = len(self.scenarios)
        return f"<trainsafe.Train {self.name!r}: {len(self)} vehicles, {scenarios} scenario{'s' * (scenarios != 1)}>"

    def _state(self) -> tuple[str, str, list[tuple[str, bytes, str]]]:
        held = [(os.fspath(path), digest, text) for path, digest, text in self._document.held]
        return self.text, os.fspath(self._document.path), held

    def __reduce__(self) -> tuple[object, ...]:
        return _train, self._state()


def _train(text: str, path: str, held: list[tuple[str, bytes, str]]) -> Train:
    return Train(_native.Document.of_text(text, path, held))


def _digest(text: str) -> bytes:
    import hashlib

    return hashlib.sha256(text.encode()).digest()


def _by_arrow(table: Any) -> Any:
    """A table of a library that does not export Arrow itself: older pandas, by pyarrow."""
    if type(table).__module__.partition(".")[0] == "pandas":
        import pyarrow

        return pyarrow.Table.from_pandas(table, preserve_index=False)
    raise TypeError(f"{type(table).__name__} is no table that exports Arrow (__arrow_c_stream__)")


def read(path: str | os.PathLike[str]) -> Train:
    """Reads a train file and the tables that it names.

    >>> import trainsafe
    >>> trainsafe.read("trains/paper-figure-4.toml").scenarios
    ['coupler 51 breaks']
    """
    return Train(_native.Document.read(os.fspath(path)))
