"""Analyses of one train."""

from __future__ import annotations

import html
import json
import operator
import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from . import _native
from ._errors import AnalysisError
from ._table import Table
from ._train import Train, read

if TYPE_CHECKING:
    import matplotlib.axes
    import matplotlib.figure
    import numpy.typing as npt


class History(NamedTuple):
    """The force in a coupler over time."""

    time_s: npt.NDArray[np.float64]
    force_n: npt.NDArray[np.float64]
    """Draft positive."""


class Field(NamedTuple):
    """The force in every coupler over time, as a share of its rating."""

    time_s: npt.NDArray[np.float64]
    coupler: npt.NDArray[np.int64]
    """The first coupler of each row, from 1; rows hold several neighbours in trains of more than 2000 couplers."""
    utilisation: npt.NDArray[np.float32]
    """By rows and instants, with the force's sign, draft positive; no number where there is no coupler."""


class Analysis:
    """What was found. It pickles and copies; the copy in another process computes again what histories and reports need.

    >>> import trainsafe
    >>> analysis = trainsafe.analyze("trains/paper-figure-4.toml")
    >>> analysis.exceeding
    48
    >>> round(max(analysis.couplers.to_dict()["utilisation"]), 3)
    1.508
    """

    def __init__(self, train: Train, options: dict[str, Any], findings: _native.Findings | None = None) -> None:
        self._train = train
        self._options = options
        self._kept = findings
        self._json: str | None = None
        self._couplers: Table | None = None
        self._cases: Table | None = None

    @property
    def _findings(self) -> _native.Findings:
        if self._kept is None:
            self._kept = _native.analyze(self._train._document, **self._options)
        return self._kept

    @property
    def train(self) -> Train:
        """The train that was analysed."""
        return self._train

    @property
    def couplers(self) -> Table:
        """Every coupler of every case: the columns of `couplers.csv`."""
        if self._couplers is None:
            self._couplers = Table(self._findings.couplers())
        return self._couplers

    @property
    def cases(self) -> Table:
        """Every case with its worst coupler: a break, a pulse or an impact each."""
        if self._cases is None:
            self._cases = Table(self._findings.cases())
        return self._cases

    def to_json(self) -> str:
        """The text of `result.json`."""
        if self._json is None:
            self._json = self._findings.json()
        return self._json

    def to_dict(self) -> dict[str, Any]:
        """What `result.json` holds, as dictionaries and lists."""
        return json.loads(self.to_json())

    def to_pandas(self) -> Any:
        """`couplers` as a DataFrame of pandas."""
        return self.couplers.to_pandas()

    def to_polars(self) -> Any:
        """`couplers` as a DataFrame of polars."""
        return self.couplers.to_polars()

    @property
    def exceeding(self) -> int:
        """Couplers over their rating, in all cases together."""
        return sum(self.cases.to_dict()["exceeding"])

    @property
    def undecided(self) -> int:
        """Couplers whose rating lies within the error bound of their largest force, in all cases together."""
        return sum(self.cases.to_dict()["undecided"])

    def summary(self) -> str:
        """The table that the command prints."""
        return self._findings.summary()

    def history(
        self,
        coupler: int | None = None,
        times_s: Sequence[float] | npt.ArrayLike | None = None,
        *,
        scenario: str | None = None,
        broken: int | None = None,
        points: int = 2001,
    ) -> History:
        """The force in a coupler (the worst one) at times up to the horizon (`points` of them), in a scenario (the first) and, of its
        breaks, the one of coupler `broken` (the worst one).

        >>> import trainsafe
        >>> analysis = trainsafe.analyze("trains/paper-figure-4.toml")
        >>> history = analysis.history(1, [0, 157.917356])
        >>> history.force_n.round(6).tolist()
        [1.0, 1.508353]
        """
        _, case, row = self._case(scenario, broken)
        worst = case["worst_coupler"]
        chosen = coupler if coupler is not None else worst
        if chosen is None:
            raise AnalysisError("no coupler is left in this case")
        horizon = case["horizon_s"]
        times = np.linspace(0.0, horizon, points) if times_s is None else np.asarray(times_s, dtype=float).ravel()
        if times.max(initial=0.0) > horizon:
            raise AnalysisError(f"forces were computed for {horizon:g} s after the event: later forces are unknown")
        index = self._train.scenarios.index(case["scenario"])
        forces = _native.history(
            self._train._document, index, case["broken_coupler"], operator.index(chosen), times.tolist()
        )
        return History(times.copy(), np.frombuffer(forces, dtype=np.float64).copy())

    def field(self, *, scenario: str | None = None, broken: int | None = None, rod: bool = False) -> Field | None:
        """The force in every coupler over time, or with `rod` that in an elastic rod in the train's place; `None` where that would
        take long, and where there is no such rod."""
        found, _, row = self._case(scenario, broken)
        parts = self._findings.field(found, row, rod)
        if parts is None:
            return None
        times, share, per_row = parts
        time_s = np.frombuffer(times, dtype=np.float64).copy()
        utilisation = np.frombuffer(share, dtype=np.float32).reshape(-1, len(time_s)).copy()
        return Field(time_s, 1 + per_row * np.arange(len(utilisation)), utilisation)

    def plot(
        self,
        coupler: int | None = None,
        *,
        scenario: str | None = None,
        broken: int | None = None,
        points: int = 2001,
        ax: matplotlib.axes.Axes | None = None,
    ) -> matplotlib.axes.Axes:
        """The force in a coupler (the worst one) over time, by matplotlib; its ratings are dashed."""
        import matplotlib.pyplot as plt

        _, case, _ = self._case(scenario, broken)
        chosen = coupler if coupler is not None else case["worst_coupler"]
        history = self.history(chosen, scenario=scenario, broken=broken, points=points)
        vehicles = self._train.vehicles.to_dict()
        draft, buff = vehicles["rated_draft_n"][chosen - 1], vehicles["rated_buff_n"][chosen - 1]
        largest = float(max(np.abs(history.force_n).max(initial=0.0), draft))
        factor, unit = next((f, u) for f, u in [(1e6, "MN"), (1e3, "kN"), (1.0, "N")] if largest >= f or u == "N")
        axes = ax if ax is not None else plt.gca()
        axes.plot(history.time_s, history.force_n / factor)
        for rating in (draft, -buff):
            axes.axhline(rating / factor, linestyle="--", color="tab:red", linewidth=1)
        axes.set(
            title=case["scenario"],
            xlabel="time after the event, s",
            ylabel=f"force in coupler {chosen}, {unit} (draft +)",
        )
        return axes

    def plot_field(
        self,
        *,
        scenario: str | None = None,
        broken: int | None = None,
        rod: bool = False,
        ax: matplotlib.axes.Axes | None = None,
    ) -> matplotlib.axes.Axes:
        """The force in every coupler by place and time, as a share of its rating, by matplotlib."""
        import matplotlib.pyplot as plt

        field = self.field(scenario=scenario, broken=broken, rod=rod)
        if field is None:
            raise AnalysisError("there is no such field: it would take long, or the train has no elastic rod in its place")
        axes = ax if ax is not None else plt.gca()
        most = float(np.nanmax(np.abs(field.utilisation)))
        last = field.coupler[-1] + 1
        image = axes.imshow(
            field.utilisation,
            aspect="auto",
            cmap="RdBu_r",
            vmin=-most,
            vmax=most,
            extent=(float(field.time_s[0]), float(field.time_s[-1]), float(last) - 0.5, 0.5),
            interpolation="nearest",
        )
        axes.set(xlabel="time after the event, s", ylabel="coupler, from the head")
        axes.figure.colorbar(image, ax=axes, label="share of the rating (draft +)")
        return axes

    def figures(self) -> dict[str, str]:
        """The report's figures, as SVG by name."""
        files = self._findings.documents(["md"])
        return {name: content.decode() for name, content in files if name.endswith(".svg")}

    def markdown(self) -> str:
        """The text of `report.md`."""
        return dict(self._findings.documents(["md"]))["report.md"].decode()

    def html(self) -> str:
        """The page `report.html`, with everything in it; some 2 MB."""
        return dict(self._findings.documents(["html"]))["report.html"].decode()

    def write(self, dir: str | os.PathLike[str], formats: Sequence[str] = ("md", "html")) -> list[str]:
        """Writes the report into a folder, as `trainsafe analyze --out` does; the files' paths."""
        return [os.fspath(path) for path in self._findings.write(os.fspath(dir), list(formats))]

    def _repr_html_(self) -> str:
        page = html.escape(self._findings.light_page(), quote=True)
        return f'<iframe srcdoc="{page}" style="width:100%;height:640px;border:0" sandbox=""></iframe>'

    def __repr__(self) -> str:
        return f"<trainsafe.Analysis of {self._train.name!r}: {len(self.cases)} cases, {self.exceeding} couplers exceed>"

    def __getstate__(self) -> dict[str, Any]:
        return {
            "train": self._train,
            "options": self._options,
            "json": self.to_json(),
            "couplers": self.couplers,
            "cases": self.cases,
        }

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__init__(state["train"], state["options"])  # type: ignore[misc]
        self._json, self._couplers, self._cases = state["json"], state["couplers"], state["cases"]

    def __copy__(self) -> Analysis:
        return Analysis(self._train, self._options, self._kept)

    def _case(self, scenario: str | None, broken: int | None) -> tuple[int, dict[str, Any], int]:
        """The scenario's place among those that were run, the case's row, and its place in the scenario."""
        columns = self.cases.to_dict()
        names = list(dict.fromkeys(columns["scenario"]))
        if scenario is None and names:
            scenario = names[0]
        if scenario not in names:
            raise AnalysisError(f"no scenario {scenario!r} was run; there are {', '.join(map(repr, names)) or 'none'}")
        rows = [dict(zip(columns, row)) for row in zip(*columns.values())]
        rows = [row for row in rows if row["scenario"] == scenario]
        if broken is None:
            row = max(range(len(rows)), key=lambda i: rows[i]["utilisation"] or 0.0)
        else:
            row = next((i for i, found in enumerate(rows) if found["broken_coupler"] == broken), -1)
        if row < 0:
            raise AnalysisError(f"coupler {broken} does not break in {scenario!r}")
        return names.index(scenario), rows[row], row


def analyze(
    train: Train | Mapping[str, Any] | str | os.PathLike[str],
    *,
    scenario: str | None = None,
    tolerance: float = 1e-9,
    method: str | None = None,
    verdict_only: bool = False,
    all_time_bound: bool = False,
    map: bool = False,
    damping: bool = False,
) -> Analysis:
    """Runs a train's scenarios, or the one of that name. `train` may be a path or a dictionary too.

    `tolerance` is the error that each force may have, as a share of the largest rating. Other Python threads run meanwhile, and Ctrl-C
    works. `all_time_bound` adds each coupler's bound over all time, `map` the smallest overloading force by duration or the safe load
    by broken coupler, `damping` the worst case with dashpots; `verdict_only` leaves out couplers that cannot exceed at any time.

    >>> import trainsafe
    >>> trainsafe.analyze("trains/paper-figure-4.toml")
    <trainsafe.Analysis of "The paper's figure 4: the last of 51 couplers breaks": 1 cases, 48 couplers exceed>
    """
    if isinstance(train, Mapping):
        train = Train.from_dict(train)
    elif not isinstance(train, Train):
        train = read(train)
    options: dict[str, Any] = {
        "scenario": scenario,
        "tolerance": float(tolerance),
        "method": method,
        "verdict_only": verdict_only,
        "all_time_bound": all_time_bound,
        "map": map,
        "damping": damping,
    }
    return Analysis(train, options, _native.analyze(train._document, **options))
