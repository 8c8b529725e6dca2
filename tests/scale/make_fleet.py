#!/usr/bin/env python3
"""Writes a fleet of train files: make_fleet.py FOLDER TRAINS [SEED].

20 to 240 vehicles each; every second train is of equal masses throughout, the others have a locomotive, loaded and empty cars
in blocks, and a few weak couplers. Masses, stiffnesses and ratings are in the range of trains/ in this project.
"""
import random
import sys
from pathlib import Path

folder, trains = Path(sys.argv[1]), int(sys.argv[2])
random.seed(int(sys.argv[3]) if len(sys.argv) > 3 else 1)
folder.mkdir(parents=True, exist_ok=True)
for number in range(trains):
    vehicles = random.randint(20, 240)
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
    (folder / f"train-{number:05}.toml").write_text("\n".join(text) + "\n")
