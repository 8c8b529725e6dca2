"""Fleets: rows, studies, progress, errors."""

import csv
import subprocess
import sys

import pytest
import trainsafe

STUDY = {"vary": [{"key": "load.uniform", "values": ["0.3 MN", "0.45 MN", "0.6 MN"]}]}


def test_rows_are_those_of_fleet_csv(tmp_path):
    paths = ["trains/ore-train.toml", "trains/paper-figure-4.toml"]
    rows = list(trainsafe.fleet(paths))
    command = [sys.executable, "-m", "trainsafe", "fleet", *paths, "--out", str(tmp_path)]
    assert subprocess.run(command, capture_output=True).returncode == 0
    with open(tmp_path / "fleet.csv", encoding="utf-8") as file:
        written = list(csv.DictReader(file))
    assert len(rows) == len(written) and list(rows[0]) == list(written[0])
    for row, cells in zip(rows, written):
        for name, cell in cells.items():
            found = row[name]
            assert (cell == "" and found is None) or str(found) == cell or float(cell) == found, (name, found, cell)


def test_a_study_of_a_train_in_memory(ore):
    heavier = ore.replace("vehicle[1].mass", "170 t")
    rows = list(trainsafe.fleet([ore, heavier], study=STUDY))
    assert len(rows) == 2 * 3 * len(ore.scenarios)
    assert {row["variation"] for row in rows} == {1, 2, 3}
    broken = [row["utilisation"] for row in rows if row["kind"] == "break"]
    assert broken[0] < broken[1] < broken[2]
    assert {row["file"] for row in rows} == {"trains/ore-train.toml (1)", "trains/ore-train.toml (2)"}
    # The same as analysing each by itself.
    alone = trainsafe.analyze(heavier.replace("load.uniform", "0.45 MN"), scenario=ore.scenarios[0])
    same = [r for r in rows if r["variation"] == 2 and r["scenario"] == ore.scenarios[0]][1]
    assert abs(same["utilisation"] - alone.cases.to_dict()["utilisation"][0]) < 1e-8


def test_draws(ore):
    study = {
        "samples": 40,
        "seed": 3,
        "vary": [{"key": "coupler.rated_load", "distribution": "uniform", "low": "0.5 MN", "high": "1.5 MN"}],
    }
    # The train is called by its own name, not by the place where it is kept for the run.
    with pytest.warns(UserWarning, match="is varied in 103 of 104 couplers of trains/ore-train.toml"):
        first, again = (list(trainsafe.fleet(ore, study=study)) for _ in range(2))
    assert len(first) == 40 * len(ore.scenarios)
    assert [r["utilisation"] for r in first] == [r["utilisation"] for r in again]


def test_a_table_goes_with_its_train():
    polars = pytest.importorskip("polars")
    train = trainsafe.Train.from_table(
        polars.DataFrame({"mass [t]": [100] * 5}),
        coupler={"stiffness": "30 MN/m", "rated_load": "1 MN"},
        load={"uniform": "0.3 MN"},
    )
    rows = list(trainsafe.fleet(train))
    assert [row["broken_coupler"] for row in rows] == [1, 2, 3, 4] and rows[0]["vehicles"] == 5


def test_progress_and_errors(tmp_path, ore):
    (tmp_path / "bad.toml").write_text("[coupler]\n")
    told = []
    rows = list(trainsafe.fleet([ore, tmp_path / "bad.toml"], progress=lambda *count: told.append(count)))
    errors = [row for row in rows if row.get("error")]
    assert len(errors) == 1 and errors[0]["file"].endswith("bad.toml") and "no vehicles" in errors[0]["error"]
    total = len(ore.scenarios) + 1
    assert told[-1] == (total, 1, total) and all(a[0] <= b[0] for a, b in zip(told, told[1:]))


def test_what_cannot_be_run_is_refused(tmp_path, ore):
    with pytest.raises(ValueError, match="does not exist"):
        list(trainsafe.fleet("nowhere.toml"))
    with pytest.raises(ValueError, match="there are no trains"):
        list(trainsafe.fleet([]))
    with pytest.raises(trainsafe.InputError) as caught:
        list(trainsafe.fleet(ore, study={"vary": [{"key": "coupler.stifness", "values": ["1 MN/m"]}]}))
    assert (caught.value.problems[0].key, caught.value.problems[0].path) == ("vary[0].key", "<study>")
    assert "--> <study>:" in str(caught.value) and "/study.toml" not in str(caught.value)
    study = tmp_path / "study.toml"
    study.write_text('trains = ["x.toml"]\n')
    with pytest.raises(ValueError, match="names its own trains"):
        list(trainsafe.fleet(ore, study=study))


def test_trains_of_one_path_are_told_apart(ore):
    told = {"coupler": {"stiffness": "30 MN/m", "rated_load": "1 MN"}, "vehicle": {"count": 3, "mass": "80 t"}, "load": {"uniform": "10 %"}}
    stiffer = ore.replace("coupler.stiffness", "60 MN/m")
    rows = list(trainsafe.fleet([ore, told, stiffer]))
    assert list(dict.fromkeys(row["file"] for row in rows)) == ["trains/ore-train.toml (1)", "<dict>", "trains/ore-train.toml (3)"]
    alone = list(trainsafe.fleet(told, study={"vary": {"key": "load.uniform", "values": ["20 %", "30 %"]}}))
    assert [row["file"] for row in alone] == ["<dict>"] * 4 and alone[-1]["variation"] == 2


def test_errors_name_the_train_and_not_where_it_was_put(ore):
    bad = ore.replace("load.uniform", "0.5 MN")
    study = {"vary": [{"key": "vehicle[9].mass", "values": ["1 t"]}]}
    try:
        said = [row["error"] for row in trainsafe.fleet(bad, study=study)]
    except trainsafe.TrainsafeError as error:
        said = [str(error)]
    assert said and all("vehicle[9]" in text and "/a/b/c/" not in text for text in said), said


def test_doubts_are_warnings():
    train = trainsafe.Train.from_dict(
        {"coupler": {"stiffness": "30 MN/m", "rated_load": "1 MN"}, "vehicle": [{"count": 3, "mass": "80 t"}]}
    )
    assert [doubt.code for doubt in train.doubts] == ["no-load"]
    with pytest.warns(UserWarning, match="load"):
        rows = list(trainsafe.fleet(train))
    assert all("no-load" in row["doubts"] for row in rows)


def test_a_run_that_is_left_ends(ore):
    study = {"samples": 5000, "seed": 1, "vary": [{"key": "load.uniform", "distribution": "uniform", "low": "0.3 MN", "high": "0.6 MN"}]}
    rows = trainsafe.fleet(ore, study=study)
    next(rows)
    rows.close()
    assert len(list(trainsafe.fleet(ore))) == len(ore.scenarios)
