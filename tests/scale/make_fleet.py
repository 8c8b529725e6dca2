#!/usr/bin/env python3
"""Writes a fleet of train files: make_fleet.py FOLDER TRAINS [SEED] [--bad COUNT] [--most VEHICLES].

20 to 240 vehicles each, or as many at most; every second train is of equal masses throughout, the others have a locomotive, loaded and empty cars
in blocks, and a few weak couplers. Masses, stiffnesses and ratings are in the range of trains/ in this project. With --bad so
many of the files, evenly spread, are then spoiled, in turn in each of the ways below.
"""
import argparse
import random
from pathlib import Path


def train(number, most):
    """The lines of a train file."""
    vehicles = random.randint(20, most)
    text = [
        f'name = "train {number}"',
        "[coupler]",
        f'stiffness = "{random.uniform(8, 40):.2f} MN/m"',
        f'rated_load = "{random.uniform(0.8, 2.0):.3f} MN"',
        "[load]",
        f'uniform = "{random.uniform(20, 80):.1f} %"',
    ]
    if number % 2 == 0:
        text += ["[[vehicle]]", f"count = {vehicles}", f'mass = "{random.uniform(60, 160):.1f} t"']
    else:
        text += ["[[vehicle]]", 'label = "locomotive"', 'mass = "180 t"']
        if random.random() < 0.5:
            text.append("held = true")
        left = vehicles - 1
        while left > 0:
            block = min(left, random.randint(1, 30))
            text += ["[[vehicle]]", f"count = {block}", f'mass = "{random.uniform(20, 130):.1f} t"']
            left -= block
        for coupler in random.sample(range(1, vehicles), 3):
            text += ["[[coupler_override]]", f"at = {coupler}", f'rated_load = "{random.uniform(60, 95):.0f} %"']
    return text


def mass(lines):
    return next(i for i, line in enumerate(lines) if line.startswith("mass"))


def replaced(lines, at, line):
    return lines[:at] + [line] + lines[at + 1 :], at + 1


def table(lines, cells, row, words):
    """Vehicles from a table beside the file, with these cells; the place is in the table."""
    return ['vehicles = "{table}"'] + lines[:6], ("{table}", row), words, "\n".join(cells) + "\n"


# Each takes a train's lines and gives the spoiled ones (or bytes), the number of the line at fault (None: the file as a whole;
# a pair: a table's name and the row in it), and words that the error must have. A table's text comes fourth.
WAYS = {
    "unknown key": lambda t: (*replaced(t, 3, t[3].replace("rated_load", "rated_lode")), "unknown key"),
    "wrong unit": lambda t: (*replaced(t, 2, 'stiffness = "30 t"'), "a unit of mass"),
    "no unit": lambda t: (*replaced(t, 2, 'stiffness = "30"'), "no unit"),
    "bare number": lambda t: (*replaced(t, 2, "stiffness = 30e6"), "no unit"),
    "unknown unit": lambda t: (*replaced(t, 2, 'stiffness = "30 MM/m"'), "unknown unit"),
    "missing vehicles": lambda t: (t[:6], None, "vehicle"),
    "one vehicle": lambda t: (t[:6] + ["[[vehicle]]", 'mass = "80 t"'], None, "one vehicle"),
    "no such coupler": lambda t: (t + ["[[scenario]]", 'kind = "break"', "coupler = 9999"], len(t) + 3, "9999"),
    "no such vehicle": lambda t: (
        t + ["[[scenario]]", 'kind = "pulse"', "at = 9999", 'force = "1 MN"', 'duration = "9 ms"'],
        len(t) + 3,
        "9999",
    ),
    "broken TOML": lambda t: (*replaced(t, 3, 'rated_load = "1 MN'), "not TOML"),
    "a key twice": lambda t: (t[:4] + [t[3]] + t[4:], 5, "duplicate key"),
    "negative mass": lambda t: (*replaced(t, mass(t), 'mass = "-80 t"'), "mass is negative"),
    "zero mass": lambda t: (*replaced(t, mass(t), 'mass = "0 t"'), "mass is zero"),
    "not a number": lambda t: (*replaced(t, mass(t), 'mass = "nan t"'), "not a finite number"),
    "beyond doubles": lambda t: (*replaced(t, mass(t), 'mass = "1e999 t"'), "too large"),
    "huge count": lambda t: (t + ["[[vehicle]]", 'mass = "80 t"', f"count = {10**15}"], len(t) + 3, "count is"),
    "held in the middle": lambda t: (
        t[:6] + ["[[vehicle]]", 'mass = "80 t"', "[[vehicle]]", 'mass = "80 t"', "held = true"] + t[6:],
        11,
        "held",
    ),
    "a list for a name": lambda t: (*replaced(t, 0, 'name = ["a"]'), "name"),
    "empty": lambda t: ([], None, "empty"),
    "a table that is not there": lambda t: (['vehicles = "gone.csv"'] + t[:6], ("gone.csv", None), "no such file"),
    "a bad cell of a table": lambda t: table(t, ["count,mass [t]", "1,180", "30,heavy", "20,60"], 3, "mass"),
    "a table without units": lambda t: table(t, ["count,mass", "1,180", "30,60"], 2, "no unit"),
    "binary": lambda t: (bytes(range(256)) * 40, None, "UTF-8"),
    "Latin-1": lambda t: ("\n".join(['name = "Güterzug"'] + t[1:]).encode("latin-1"), None, "UTF-8"),
}


def spoil(path, way):
    """Spoils a train file; which place the error must name and which words it must have."""
    content, line, words, *cells = WAYS[way](path.read_text().splitlines())
    table = path.with_suffix(".csv")
    if isinstance(content, list):
        content = "".join(text.replace("{table}", table.name) + "\n" for text in content).encode()
    path.write_bytes(content)
    at = path
    for text in cells:
        table.write_text(text)
    if isinstance(line, tuple):
        at, line = path.parent / line[0].replace("{table}", table.name), line[1]
    return f"{at}:" if line is None else f"{at}:{line}:", words


def write(folder, trains, seed=1, bad=0, most=240):
    """Writes the fleet; of each spoiled file, the way, the place and the words."""
    random.seed(seed)
    folder.mkdir(parents=True, exist_ok=True)
    for number in range(trains):
        (folder / f"train-{number:05}.toml").write_text("\n".join(train(number, most)) + "\n")
    ways = list(WAYS)
    spoiled = {}
    for i in range(bad):
        path = folder / f"train-{(2 * i + 1) * trains // (2 * bad):05}.toml"
        way = ways[i % len(ways)]
        spoiled[str(path)] = (way, *spoil(path, way))
    return spoiled


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("trains", type=int)
    parser.add_argument("seed", type=int, nargs="?", default=1)
    parser.add_argument("--bad", type=int, default=0, metavar="COUNT")
    parser.add_argument("--most", type=int, default=240, metavar="VEHICLES")
    arguments = parser.parse_args()
    write(arguments.folder, arguments.trains, arguments.seed, arguments.bad, arguments.most)
