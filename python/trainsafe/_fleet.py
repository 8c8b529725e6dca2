"""Many trains and what-ifs."""

from __future__ import annotations

import json
import os
import tempfile
import warnings
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any, Union

from . import _native, _toml
from ._errors import AnalysisError, TrainsafeError, with_names
from ._train import Train

Trains = Union[Train, Mapping[str, Any], str, "os.PathLike[str]"]


def fleet(
    trains: Trains | Iterable[Trains] | None = None,
    *,
    study: Mapping[str, Any] | str | os.PathLike[str] | None = None,
    tolerance: float = 1e-9,
    method: str | None = None,
    progress: Callable[[int, int, int], None] | None = None,
) -> Iterator[dict[str, Any]]:
    """Yields a row for every case of every train: the columns of `fleet.csv`, as they are computed, in order. A train or case that
    cannot be computed is a row with `error` and the columns of `errors.csv`.

    `trains` are train files, folders, globs, `Train` objects or dictionaries with the keys of a train file. `Train` objects of one path
    are told apart by their place among `trains`: the `file` of their rows is `ore-train.toml (1)` and so on. A `study` is a file that
    names its own trains, or a dictionary with a study's keys but for `trains`. `progress` is called with how many cases are done, how
    many of them failed, and how many there are. Notes on the run are Python warnings at the end.

    >>> import trainsafe
    >>> train = trainsafe.read("trains/ore-train.toml")
    >>> study = {"vary": [{"key": "load.uniform", "values": ["0.3 MN", "0.6 MN"]}]}
    >>> rows = list(trainsafe.fleet(train, study=study))
    >>> [round(row["utilisation"], 2) for row in rows if row["kind"] == "break"]
    [0.3, 0.6]
    """
    if trains is None or isinstance(trains, (Train, Mapping, str, os.PathLike)):
        trains = [] if trains is None else [trains]
    given = [Train.from_dict(train) if isinstance(train, Mapping) else train for train in trains]
    held = Counter(os.fspath(train._document.path) for train in given if isinstance(train, Train))
    with tempfile.TemporaryDirectory(prefix="trainsafe-") as folder:
        paths, names = [], {}
        for number, train in enumerate(given):
            if isinstance(train, Train):
                path = _put(train, os.path.join(folder, str(number)))
                name = os.fspath(train._document.path)
                names[path] = f"{name} ({number + 1})" if held[name] > 1 else name
                paths.append(path)
            else:
                paths.append(os.path.abspath(train) if study is not None else os.fspath(train))
        paths = _with_study(paths, study, folder)
        if isinstance(study, Mapping):
            names[paths[0]] = "<study>"
        try:
            yield from _rows(_native.FleetRun(paths, float(tolerance), method), progress, names)
        except TrainsafeError as error:
            raise error.with_names(names) from None


def _rows(
    run: _native.FleetRun, progress: Callable[[int, int, int], None] | None, names: dict[str, str]
) -> Iterator[dict[str, Any]]:
    told = None
    try:
        while True:
            lines, notes = run.next(0.1)
            if progress is not None and (count := run.count()) != told:
                told = count
                progress(*count)
            for line in (lines or "").splitlines():
                row = json.loads(line)
                row["file"] = names.get(row["file"], row["file"])
                if row.get("error"):
                    row["error"] = with_names(row["error"], names)
                yield row
            if notes is not None:
                for note in notes:
                    warnings.warn(with_names(note, names), stacklevel=3)
                return
    finally:
        run.stop()


def _with_study(paths: list[str], study: Any, folder: str) -> list[str]:
    if study is None:
        if not paths:
            raise AnalysisError("there are no trains: give train files, folders, globs or Train objects, or a study")
        return paths
    if not isinstance(study, Mapping):
        if paths:
            raise AnalysisError("a study file names its own trains: give it alone, or the study as a dictionary")
        return [os.fspath(study)]
    if "trains" in study and paths:
        raise AnalysisError("the study names its own trains: leave them out on one side")
    own = [os.path.abspath(train) for train in study.get("trains", [])]
    path = os.path.join(folder, "study.toml")
    with open(path, "w", encoding="utf-8") as file:
        file.write(_toml.document({**study, "trains": paths or own}))
    return [path]


def _put(train: Train, folder: str) -> str:
    """Writes a train and the files that it names, with the same relative paths."""
    text, path, held = train._state()
    home = os.path.join(folder, "a", "b", "c")
    os.makedirs(home)
    for name, _, content in held:
        beside = os.path.relpath(name, os.path.dirname(path) or ".") if not os.path.isabs(name) else name
        target = os.path.normpath(os.path.join(home, beside))
        if not target.startswith(folder):
            if os.path.exists(target):
                continue
            raise AnalysisError(f"{name} lies too far from the train file to be kept with it")
        os.makedirs(os.path.dirname(target), exist_ok=True)
        with open(target, "w", encoding="utf-8", newline="") as file:
            file.write(content)
    written = os.path.join(home, "train.toml")
    with open(written, "w", encoding="utf-8", newline="") as file:
        file.write(text)
    return written
