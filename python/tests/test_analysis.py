"""Analyses: numbers, tables, figures; interruption, threads, forks, copies."""

import copy
import json
import multiprocessing
import os
import pickle
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
import trainsafe


def test_the_papers_figure_4(figure_4):
    """Numbers as the theory gives them, to 1e-10."""
    first = {name: column[0] for name, column in figure_4.couplers.to_dict().items()}
    assert first["coupler"] == 1 and first["exceeds"] is True
    assert abs(first["peak_force_n"] - 1.50835269566244) < 1e-10
    assert abs(first["first_exceeds_s"] - 53.1520898066266) < 1e-10
    assert len(figure_4.couplers) == 50 and figure_4.exceeding == 48
    case = {name: column[0] for name, column in figure_4.cases.to_dict().items()}
    assert case["worst_coupler"] == 1 and case["error_bound_n"] < 1e-9


def test_tables_are_what_the_command_writes(figure_4, tmp_path):
    import csv

    written = figure_4.write(tmp_path / "report")
    assert written[-1].endswith("report.md") and os.path.exists(tmp_path / "report" / "result.json")
    with open(tmp_path / "report" / "couplers.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    table = figure_4.couplers.to_dict()
    assert list(rows[0]) == list(table)

    def text(cell):
        return "" if cell is None else str(cell).lower() if isinstance(cell, bool) else cell if isinstance(cell, str) else float(cell)

    for i, row in enumerate(rows):
        for name, cell in row.items():
            found = text(table[name][i])
            assert (float(cell) if isinstance(found, float) else cell) == found, (i, name)
    assert figure_4.to_dict()["scenarios"][0]["cases"][0]["exceeding"] == 48
    assert json.loads((tmp_path / "report" / "result.json").read_text()) == figure_4.to_dict()


def test_options(ore):
    one = trainsafe.analyze(ore, scenario="the rear is hit", tolerance=1e-6, all_time_bound=True)
    assert set(one.couplers.to_dict()["scenario"]) == {"the rear is hit"}
    assert one.couplers.columns[-1] == "all_time_bound_n"
    with pytest.raises(ValueError, match="no scenario is named"):
        trainsafe.analyze(ore, scenario="no such")
    with pytest.raises(ValueError, match="between 0 and 1"):
        trainsafe.analyze(ore, tolerance=2)
    with pytest.raises(ValueError, match="no method is named"):
        trainsafe.analyze(ore, method="magic")


def test_history_and_field(figure_4):
    history = figure_4.history()
    assert history.time_s.dtype == history.force_n.dtype == np.float64
    assert history.time_s[0] == 0 and history.force_n[0] == 1 and len(history.time_s) == 2001
    peak = figure_4.history(1, [157.917356441113]).force_n[0]
    assert abs(peak - 1.50835269566244) < 1e-6
    history.force_n[0] = 2  # It is the caller's own.
    field = figure_4.field()
    assert field.utilisation.shape == (len(field.coupler), len(field.time_s)) and len(field.coupler) == 51
    assert abs(np.nanmax(field.utilisation) - 1.50835269566244) < 1e-6
    assert np.isnan(field.utilisation[50]).all()  # The broken one.
    rod = figure_4.field(rod=True)
    assert np.nanmax(np.abs(rod.utilisation)) < 1.0 + 1e-6
    for wrong in ({"coupler": 0}, {"coupler": 52}, {"times_s": [-1.0]}, {"times_s": [2.0, 1.0]}, {"times_s": [1e9]}, {"coupler": -1}, {"scenario": "x"}, {"broken": 3}):
        with pytest.raises(trainsafe.AnalysisError) as caught:
            figure_4.history(**{"coupler": 1, **wrong})
        assert caught.value.problems == []
    with pytest.raises(TypeError):
        figure_4.history(2.5)


def test_a_break_of_each_coupler_has_a_case_of_its_own(ore):
    each = trainsafe.analyze(ore.replace("scenario[0].coupler", "each"), scenario=ore.scenarios[0])
    assert len(each.cases) == 104 and len(each.couplers) == 104 * 103
    assert len(each.history(1, [0.0, 1.0], broken=53).force_n) == 2
    with pytest.raises(ValueError, match="does not break"):
        each.history(1, broken=105)


def test_frames(figure_4):
    pandas = pytest.importorskip("pandas")
    pytest.importorskip("pyarrow")
    frame = figure_4.to_pandas()
    assert isinstance(frame, pandas.DataFrame) and frame.shape == (50, len(figure_4.couplers.columns))
    assert frame["peak_force_n"].dtype == "float64"
    assert abs(frame["utilisation"].max() - 1.50835269566244) < 1e-10


def test_frames_of_polars(figure_4):
    polars = pytest.importorskip("polars")
    frame = figure_4.to_polars()
    assert frame.schema["exceeds"] == polars.Boolean and frame.schema["coupler"] == polars.Int64
    assert frame.height == 50 and figure_4.cases.to_polars().height == 1


def test_duckdb_reads_a_table(figure_4):
    duckdb = pytest.importorskip("duckdb")
    pytest.importorskip("pyarrow")
    couplers = figure_4.couplers.to_arrow()
    assert duckdb.sql("select count(*) from couplers where exceeds").fetchall() == [(48,)]


def test_pages_and_figures(figure_4):
    light = figure_4._repr_html_()
    assert light.startswith("<iframe srcdoc=") and "&lt;svg" in light and "&lt;script" not in light
    assert len(light) < 600_000 < len(figure_4.html())
    assert figure_4.markdown().startswith("# The paper's figure 4")
    figures = figure_4.figures()
    assert "figure-1-force.svg" in figures and all(svg.startswith("<svg") for svg in figures.values())
    assert "coupler" in figure_4.summary()


def test_plots(figure_4):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    _, (above, below) = plt.subplots(2)
    assert figure_4.plot(ax=above) is above
    assert above.get_ylabel() == "force in coupler 1, N (draft +)" and len(above.lines) == 3
    assert figure_4.plot_field(ax=below) is below
    plt.close("all")


def test_pickles_and_copies(figure_4, tmp_path):
    again = pickle.loads(pickle.dumps(figure_4))
    assert again.to_json() == figure_4.to_json()
    assert again.couplers.to_dict() == figure_4.couplers.to_dict()
    assert again.cases.columns == figure_4.cases.columns
    assert (again.history().force_n == figure_4.history().force_n).all()
    assert again.markdown().split("Run")[0] == figure_4.markdown().split("Run")[0]
    assert copy.copy(figure_4).to_json() == copy.deepcopy(figure_4).to_json() == figure_4.to_json()


def analyze_in_child(queue):
    queue.put(trainsafe.analyze("trains/paper-figure-4.toml").exceeding)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_a_fork_after_an_analysis_does_not_hang(figure_4):
    context = multiprocessing.get_context("fork")
    queue = context.Queue()
    children = [context.Process(target=analyze_in_child, args=(queue,)) for _ in range(3)]
    for child in children:
        child.start()
    found = [queue.get(timeout=60) for _ in children]
    for child in children:
        child.join(timeout=60)
        assert child.exitcode == 0
    assert found == [48, 48, 48]


def test_other_threads_run_meanwhile(ore):
    """A thread counts while an analysis of about a second is under way."""
    long = ore.replace("scenario[0].coupler", "each")
    ticks, done = [], threading.Event()

    def tick():
        while not done.is_set():
            ticks.append(time.monotonic())
            time.sleep(0.005)

    thread = threading.Thread(target=tick)
    thread.start()
    start = time.monotonic()
    trainsafe.analyze(long)
    took = time.monotonic() - start
    done.set()
    thread.join()
    within = [t for t in ticks if start <= t <= start + took]
    # Half of the ticks at least, on a machine that is busy.
    assert took < 0.05 or len(within) > 0.2 * took / 0.005, (took, len(within))


SLOW = """
import signal, sys, time, trainsafe
signal.signal(signal.SIGINT, signal.default_int_handler)
train = trainsafe.Train.from_dict({
    "coupler": {"stiffness": "30 MN/m", "rated_load": "1.5 MN", "damping": "100 kN*s/m"},
    "vehicle": [{"count": 400, "mass": "80 t"}], "load": {"uniform": "0.5 MN"},
    "scenario": [{"kind": "break", "coupler": "each", "horizon": "60 s"}],
})
print("ready", flush=True)
try:
    CALL
except KeyboardInterrupt:
    print("interrupted", flush=True)
else:
    print("finished", flush=True)
"""


@pytest.mark.skipif(os.name != "posix", reason="needs signals")
@pytest.mark.parametrize("call", ["trainsafe.analyze(train)", "list(trainsafe.fleet([train]))"])
def test_ctrl_c_is_obeyed_within_a_second(call):
    run = subprocess.Popen([sys.executable, "-c", SLOW.replace("CALL", call)], stdout=subprocess.PIPE, text=True)
    assert run.stdout.readline() == "ready\n"
    time.sleep(1.5)
    sent = time.monotonic()
    run.send_signal(signal.SIGINT)
    said = run.stdout.readline()
    took = time.monotonic() - sent
    run.wait(timeout=120)
    assert said == "interrupted\n" and took < 1.0, (said, took)


def test_the_command_comes_with_the_package(tmp_path):
    run = [sys.executable, "-m", "trainsafe"]
    check = subprocess.run([*run, "check", "trains/ore-train.toml"], capture_output=True, text=True)
    assert check.returncode == 0 and check.stdout.startswith("Ore train")
    bad = subprocess.run([*run, "check", "-"], input="", capture_output=True, text=True)
    assert bad.returncode == 2 and "the train file is empty" in bad.stderr
    version = subprocess.run([*run, "--version"], capture_output=True, text=True)
    assert version.stdout == f"trainsafe {trainsafe.__version__}\n"


def test_a_workbook_is_read():
    train = trainsafe.Train.from_text(
        'vehicles = "consist.xlsx"\n[coupler]\nstiffness = "30 MN/m"\nrated_load = "1 MN"\n', "tests/workbooks/t.toml"
    )
    assert train.vehicles.to_dict()["mass_kg"] == [195e3, 81125.0, 94300.0, 94300.0]
