"""Chains whose modes are all damped alike, in 40-digit arithmetic: writes modal_damping.json beside itself. Needs mpmath.

Another way than the program's: no modes. With C the square root of the matrix A of the scaled displacements, x'' + 2 z C x' + A x
= f is carried on by Taylor series; extremes are bracketed on a grid of instants and closed in on by bisection.
"""

import json
import os

from mpmath import diag, eighe, matrix, mp, mpf

from motions import K, M, bisect, dot, value

mp.dps = 40
TERMS = 30


def play(case):
    live = [v for v in range(len(M)) if not (v == 0 and case["held_head"])]
    n, z = len(live), mpf(case["ratio"])
    # Displacements scaled by the root of the mass; springs as rows on them.
    rows = []
    for i in range(len(K)):
        row = matrix(1, n)
        for v, sign in ((i, 1), (i + 1, -1)):
            if v in live:
                row[live.index(v)] = sign * mpf(K[i]) / mp.sqrt(M[v])
        rows.append(row)
    a = matrix(n, n)
    for i in range(len(K)):
        for p in range(n):
            for q in range(n):
                a[p, q] += rows[i][p] * rows[i][q] / mpf(K[i])
    values, vectors = eighe(a)
    c = vectors * diag([mp.sqrt(abs(w)) for w in values]) * vectors.T
    push = matrix(n, 1)
    s = live.index(case["source"])
    push[s] = mpf(case["force"]) / mp.sqrt(M[case["source"]])
    x, v, t, h = matrix(n, 1), matrix(n, 1), mpf(0), mpf(1) / 20
    duration, horizon = mpf(case["duration"]), mpf(case["horizon"])
    peaks = [[max(mpf(f), 0), max(-mpf(f), 0)] for f in case["initial"]]
    wanted, samples = [mpf(w) for w in case["times"]], []
    while t < horizon:
        end = min(h, horizon - t, duration - t if t < duration else horizon)
        force = push if t < duration else 0 * push
        terms, speed = [x], v
        for k in range(TERMS):
            rate = -(a * terms[-1]) - 2 * z * (c * speed) + (force if k == 0 else 0 * force)
            terms.append(speed / (k + 1))
            speed = rate / (k + 1)
        polys = [[dot(r, term) for term in terms] for r in rows]
        for i, p in enumerate(polys):
            p[0] += mpf(case["initial"][i])
            slope = [k * p[k] for k in range(1, len(p))]
            points = [mpf(0), end]
            if value(slope, mpf(0)) * value(slope, end) < 0:
                points.append(bisect(lambda s: value(slope, s), mpf(0), end))
            for s in points:
                peaks[i] = [max(peaks[i][0], value(p, s)), max(peaks[i][1], -value(p, s))]
        while wanted and t <= wanted[0] <= t + end:
            samples.append([value(p, wanted[0] - t) for p in polys])
            wanted.pop(0)
        x, v = (sum((terms[k] * end**k for k in range(1, len(terms))), terms[0]),
                sum((terms[k] * (k * end ** (k - 1)) for k in range(2, len(terms))), terms[1]))
        t += end
    return {**case, "mass": M, "stiffness": K, "peaks": [[mp.nstr(p, 25) for p in pair] for pair in peaks],
            "samples": [[mp.nstr(f, 25) for f in row] for row in samples]}


BASE = {"held_head": True, "source": 5, "force": 0.75, "duration": 99.0, "ratio": 0.2, "horizon": 20.0,
        "initial": [0.5, 0.5, 0.25, 0.25, 0.25], "times": [0.5, 1.75, 4.0, 8.25, 13.0, 19.5]}
CASES = [
    {**BASE, "name": "held head, step at the tail"},
    {**BASE, "name": "held head, pulse in the middle", "source": 2, "duration": 1.625, "ratio": 0.05},
    {**BASE, "name": "free, brief pulse at the head", "held_head": False, "source": 0, "duration": 0.0009765625,
     "force": -512.0},
    {**BASE, "name": "free, step, nearly critical", "held_head": False, "source": 5, "ratio": 0.875},
]

if __name__ == "__main__":
    here = os.path.dirname(os.path.abspath(__file__))
    with open(os.path.join(here, "modal_damping.json"), "w") as out:
        json.dump([play(case) for case in CASES], out, indent=1)
        out.write("\n")
