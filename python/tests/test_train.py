"""Trains: from files, dictionaries and tables; changed, copied, refused."""

import copy
import pickle

import pytest
import trainsafe

SMALL = {
    "name": "small",
    "coupler": {"stiffness": "30 MN/m", "rated_load": "1.5 MN", "limits": {"ultimate": "2.9 MN"}},
    "vehicle": [{"label": 'a "b"', "mass": "195 t", "held": True}, {"label": "Grün", "count": 4, "mass": "80 t"}],
    "load": {"uniform": "40 %"},
    "scenario": [{"name": "third", "kind": "break", "coupler": [3]}],
}


def test_a_dictionary_is_the_train_that_its_text_is():
    text = """
        name = "small"
        [coupler]
        stiffness = "30 MN/m"
        rated_load = "1.5 MN"
        limits = { ultimate = "2.9 MN" }
        [[vehicle]]
        label = 'a "b"'
        mass = "195 t"
        held = true
        [[vehicle]]
        label = "Grün"
        count = 4
        mass = "80 t"
        [load]
        uniform = "40 %"
        [[scenario]]
        name = "third"
        kind = "break"
        coupler = [3]
    """
    train = trainsafe.Train.from_dict(SMALL)
    assert train.vehicles.to_dict() == trainsafe.Train.from_text(text).vehicles.to_dict()
    assert (train.name, len(train), train.scenarios) == ("small", 5, ["third"])
    assert train.vehicles.to_dict()["label"][:2] == ['a "b"', "Grün 1"]
    assert trainsafe.analyze(SMALL).cases.to_dict()["broken_coupler"] == [3]


def test_quantities_of_pint():
    pint = pytest.importorskip("pint")
    unit = pint.UnitRegistry()
    train = trainsafe.Train.from_dict(
        {**SMALL, "coupler": {"stiffness": 30 * unit.meganewton / unit.meter, "rated_load": 1.5e6 * unit.newton}}
    )
    assert train.vehicles.to_dict()["stiffness_n_per_m"][0] == 30e6
    assert train.vehicles.to_dict()["rated_draft_n"][0] == 1.5e6
    stiffer = train.replace("coupler.damping", 200 * unit.kilonewton * unit.second / unit.meter)
    assert "damping" in stiffer.text


def test_replace_changes_one_key_and_not_the_train_it_is_called_on(ore):
    other = ore.replace("vehicle[1].mass", "100 t").replace("coupler.rated_load", "2 MN")
    assert other.vehicles.to_dict()["mass_kg"][1] == 100e3
    assert ore.vehicles.to_dict()["mass_kg"][1] != 100e3
    assert other != ore and ore == trainsafe.read("trains/ore-train.toml")
    with pytest.raises(ValueError, match='has no key "stifness"'):
        ore.replace("coupler.stifness", "30 MN/m")
    with pytest.raises(trainsafe.InputError, match="a unit of force") as caught:
        ore.replace("coupler.stiffness", "30 MN")
    assert caught.value.problems[0].key == "coupler.stiffness"
    with pytest.raises(TypeError, match="no form in a train file"):
        ore.replace("coupler.stiffness", object())


def test_a_list_of_one_table_may_be_the_table():
    keys = {"coupler": {"stiffness": "30 MN/m", "rated_load": "1 MN"}, "load": {"uniform": "40 %"}}
    vehicle, event = {"count": 3, "mass": "80 t"}, {"kind": "break", "coupler": 2}
    alone = trainsafe.Train.from_dict({**keys, "vehicle": vehicle, "scenario": event})
    assert alone == trainsafe.Train.from_dict({**keys, "vehicle": [vehicle], "scenario": [event]})


def test_errors_are_value_errors_with_places(tmp_path):
    path = tmp_path / "bad.toml"
    path.write_text('[coupler]\nstiffness = "30 MN/m"\nrated_load = "1 t"\n[[vehicle]]\nmass = "80 t"\ncount = 0\n')
    with pytest.raises(ValueError) as caught:
        trainsafe.read(path)
    first, second = caught.value.problems
    assert (first.path, first.line, first.column, first.key) == (str(path), 3, 14, "coupler.rated_load")
    assert path.read_bytes()[slice(*first.span)] == b'"1 t"'
    assert first.help == "a force is in N, kN, MN, lbf or kip"
    assert (second.line, second.key) == (6, "vehicle[0].count")
    again = pickle.loads(pickle.dumps(caught.value))
    assert (again.problems, str(again)) == (caught.value.problems, str(caught.value))
    with pytest.raises(ValueError, match="there is no such file"):
        trainsafe.read("nowhere.toml")


def test_a_train_is_pickled_with_the_files_that_it_names(tmp_path):
    (tmp_path / "consist.csv").write_bytes("label;mass [t]\nWagen;80,5\nWagen;80,5\n".encode("utf-16"))
    path = tmp_path / "t.toml"
    path.write_text('vehicles = "consist.csv"\n[coupler]\nstiffness = "30 MN/m"\nrated_load = "1 MN"\n')
    train = trainsafe.read(path)
    inputs = trainsafe.analyze(train).to_dict()["inputs"]
    data = pickle.dumps(train)
    for file in tmp_path.iterdir():
        file.unlink()
    again = pickle.loads(data)
    assert again.vehicles.to_dict()["mass_kg"] == [80500.0, 80500.0]
    assert again == train == copy.deepcopy(train) == copy.copy(train) and hash(again) == hash(train)
    # The digests are still those of the bytes that were read.
    assert trainsafe.analyze(again).to_dict()["inputs"][1] == inputs[1]
    assert again.replace("coupler.rated_load", "2 MN").vehicles.to_dict()["mass_kg"] == [80500.0, 80500.0]


def rows():
    return {
        "label": ["loco", "car", "car"],
        "mass [t]": [195.0, 81.125, None],
        "held": [True, False, False],
        "rated_load": ["1.2 MN", None, None],
    }


def test_a_table_of_polars():
    polars = pytest.importorskip("polars")
    frame = polars.DataFrame(rows()).with_columns(polars.col("mass [t]").fill_null(80))
    check(frame)
    check(frame.with_columns(polars.col("label").cast(polars.Categorical), polars.col("mass [t]").cast(polars.Decimal(10, 3))))


def test_a_table_of_pandas():
    pandas = pytest.importorskip("pandas")
    pytest.importorskip("pyarrow")
    frame = pandas.DataFrame(rows()).fillna({"mass [t]": 80})
    check(frame)
    check(frame.astype({"label": "category", "mass [t]": "float32"}))


def test_a_table_of_duckdb():
    duckdb = pytest.importorskip("duckdb")
    pytest.importorskip("pyarrow")
    check(
        duckdb.sql(
            """select * from (values ('loco', 195::double, true, '1.2 MN'), ('car', 81.125, false, null), ('car', 80, false, null))
            as t(label, "mass [t]", held, rated_load)"""
        )
    )


def check(table):
    train = trainsafe.Train.from_table(
        table, name="by table", coupler={"stiffness": "30 MN/m", "rated_load": "1 MN"}, load={"uniform": "0.4 MN"}
    )
    found = train.vehicles.to_dict()
    assert found["mass_kg"] == [195e3, 81125.0, 80e3]
    assert found["held"] == [True, False, False]
    assert found["rated_draft_n"] == [1.2e6, 1e6, None]
    assert (train.name, found["label"]) == ("by table", ["loco", "car 1", "car 2"])
    assert pickle.loads(pickle.dumps(train)) == train


def test_what_is_wrong_with_a_table_is_told_by_row_and_column():
    polars = pytest.importorskip("polars")
    keys = {"coupler": {"stiffness": "30 MN/m", "rated_load": "1 MN"}}
    with pytest.raises(trainsafe.InputError, match="row 4, column mass .t.: there is no mass") as caught:
        trainsafe.Train.from_table(polars.DataFrame(rows()), **keys)
    assert caught.value.problems[0].path == "<table>"
    with pytest.raises(ValueError, match="the column mass has no unit"):
        trainsafe.Train.from_table(polars.DataFrame({"mass": [80, 90]}), **keys)
    with pytest.raises(ValueError, match="neither text nor numbers"):
        trainsafe.Train.from_table(polars.DataFrame({"mass [t]": [[80], [90]]}), **keys)
    dates = polars.DataFrame({"mass [t]": [1, 2]}).with_columns(polars.date(2026, 1, 1).alias("mass [t]"))
    with pytest.raises(ValueError, match="a date or time"):
        trainsafe.Train.from_table(dates, **keys)
    with pytest.raises(TypeError, match="exports Arrow"):
        trainsafe.Train.from_table([1, 2])
    odd = polars.DataFrame({"mass [t]": [80, 90], "colour": ["red", "blue"]})
    assert [d.code for d in trainsafe.Train.from_table(odd, **keys).doubts][0] == "column-not-read"
