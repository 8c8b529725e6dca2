"""The paper's formulas as printed, checked against Taylor series of the equations of motion: writes paper.json.

(19), and (29) with (27)'s right-hand side taken as a_j, in 50 digits, for N from 1 to 300; the same by Taylor series of
u'' = -A u + f, with A of (3), in whole numbers of 2^-220. The two must agree to 1e-40; what is written is the Taylor
series' values. Then the numbers of figures 4 and 5, from Bessel functions where the paper's chain is endless as far as
a link can tell, the limit of a long chain, and the all-time bounds.

Run: pip install gmpy2 mpmath; python3 tests/reference/paper.py        (about two minutes)
"""

import json
import os
import sys

import mpmath
from mpmath import cos, mp, mpf, pi, sin, sqrt

mp.dps = 60
SHIFT = 220
ONE = 1 << SHIFT


class Paper:
    """Equations (10), (13), (19), (27) and (29), link i = 1..N."""

    def __init__(self, n):
        self.n = n
        self.beta = [pi * (2 * j - 1) / (2 * n + 1) for j in range(1, n + 1)]
        self.omega = [2 * sin(pi * (2 * j - 1) / (4 * n + 2)) for j in range(1, n + 1)]

    def r(self, i, j):
        return cos(pi * (2 * i - 1) * (2 * j - 1) / (4 * self.n + 2)) / cos(pi * (2 * j - 1) / (4 * self.n + 2))

    def eq19(self, t):
        waves = [
            (-1) ** j * sin(b) / (1 - cos(b)) * cos(w * t) for j, (b, w) in enumerate(zip(self.beta, self.omega))
        ]
        return [
            2 / mpf(2 * self.n + 1) * mpmath.fsum(x * cos(b / 2 * (2 * i - 1)) for x, b in zip(waves, self.beta))
            for i in range(1, self.n + 1)
        ]

    def a(self, j):
        """(27), whose right-hand side is a_j, for f = 1."""
        return (-1) ** (j + 1) * 4 * cos(pi * (2 * j - 1) / (4 * self.n + 2)) ** 2 / mpf(2 * self.n + 1)

    def eq29(self, t, pulse):
        def wave(j):
            w = self.omega[j - 1]
            if t < pulse:
                return self.a(j) / w * (1 - cos(w * t))
            return self.a(j) / w * (cos(w * (t - pulse)) - cos(w * t))

        waves = [wave(j) for j in range(1, self.n + 1)]
        return [
            mpmath.fsum(x * self.r(i, j) for j, x in enumerate(waves, start=1)) for i in range(1, self.n + 1)
        ]

    def all_time(self, i):
        """Sum of the sizes of (19)'s terms."""
        return 2 / mpf(2 * self.n + 1) * mpmath.fsum(
            abs(sin(b) * cos(b / 2 * (2 * i - 1)) / (1 - cos(b))) for b in self.beta
        )


def apply(u):
    """A of (3), in link forces: 1 in the first diagonal place."""
    n = len(u)
    return [
        (u[0] if i == 0 else 2 * u[i] - u[i - 1]) - (u[i + 1] if i + 1 < n else 0) for i in range(n)
    ]


def march(u, v, force, time, steps):
    """u'' = -A u + force e_N over `time`, in `steps` equal steps of Taylor series."""
    h = time / steps
    assert mpf(h) * (1 << 30) == int(mpf(h) * (1 << 30)), "steps of a whole number of 2^-30"
    num = int(mpf(h) * (1 << 30))
    for _ in range(steps):
        new_u, new_v = u, v
        acceleration = [-x for x in apply(u)]
        acceleration[-1] += force
        # Terms u^(q) h^q / q!; the even ones from u, the odd ones from v.
        even, odd = acceleration, [x * num >> 30 for x in v]
        even = [(x * num * num >> 60) // 2 for x in even]
        q = 1
        while True:
            # Here odd is the term q, even the term q + 1.
            new_u = [x + y + z for x, y, z in zip(new_u, odd, even)]
            new_v = [x + (((q + 1) * y) << 30) // num for x, y in zip(new_v, even)]
            if q > 1:
                new_v = [x + ((q * y) << 30) // num for x, y in zip(new_v, odd)]
            if max(map(abs, even)) + max(map(abs, odd)) < 1 << 12:
                break
            odd = [-(x * num * num >> 60) // ((q + 1) * (q + 2)) for x in apply(odd)]
            even = [-(x * num * num >> 60) // ((q + 2) * (q + 3)) for x in apply(even)]
            q += 2
        u, v = new_u, new_v
    return u, v


def values(n):
    """Links' values under (19) and (29) at a few times, by Taylor series, checked against the paper's formulas."""
    paper, pulse = Paper(n), 10.0
    times = [0.25, 0.5 * n + 0.25, 1.5 * n, 3.75 * n]
    broken, pulled = [], []
    u, v, now = [ONE] * n, [0] * n, 0.0
    for t in times:
        u, v = march(u, v, 0, t - now, power(t - now))
        now = t
        broken.append(check(u, paper.eq19(mpf(t)), n))
    u, v, now = [0] * n, [0] * n, 0.0
    for t in sorted(set(times + [pulse])):
        steps = power(t - now)
        u, v = march(u, v, ONE if now < pulse else 0, t - now, steps)
        now = t
        found = check(u, paper.eq29(mpf(t), mpf(pulse)), n)
        if t in times:
            pulled.append(found)
    return {"n": n, "times": times, "pulse": pulse, "eq19": broken, "eq29": pulled}


def power(t):
    """A number of steps, a power of two, that makes steps of 0.5 to 1."""
    steps = 1
    while t / steps > 1.0:
        steps *= 2
    return steps


def check(u, formula, n):
    taylor = [mpf(x) / ONE for x in u]
    worst = max(abs(x - y) for x, y in zip(taylor, formula))
    assert worst < mpf("1e-40"), (n, worst)
    return [mpmath.nstr(x, 30) for x in taylor]


def front(n, t):
    """S_n + S_{n+1} on an endless chain: J_2n + 2 J_2n+2 + ... + the same from n + 1 on; and its slope."""
    x = 2 * t
    top = int(x + 30 * x ** (mpf(1) / 3) + 60)
    top += top % 2
    above, here, total = mpf(0), mpf("1e-200"), mpf(0)
    j = {top: here}
    for order in range(top, 0, -1):
        above, here = here, 2 * order / x * here - above
        j[order - 1] = here
    norm = j[0] + 2 * mpmath.fsum(j[k] for k in range(2, top, 2))
    tail = mpmath.fsum(j[k] for k in range(2 * n + 4, top, 2))
    value = j[2 * n] + 3 * j[2 * n + 2] + 4 * tail
    # d/dt S_n = J_{2n-1} + J_{2n+1}
    slope = j[2 * n - 1] + 2 * j[2 * n + 1] + j[2 * n + 3]
    return value / norm, slope / norm


def first_pass(n):
    """The extremum of link 1 when the front first reaches it: 1 - (S_N + S_{N+1}), and its time."""
    late = n + 1.5 * mpf(n) ** (mpf(1) / 3) + 0.5
    mp.dps = 50
    t = mpmath.findroot(lambda t: front(n, t)[1], (late, late + 0.5), solver="secant", tol=1e-80)
    return 1 - front(n, t)[0], t


def figures():
    s = lambda x: mpmath.nstr(x, 30)
    paper = Paper(50)
    link1 = lambda t: paper_link1(paper, t)
    slope = lambda t: mpmath.diff(link1, t)
    trend = []
    for n in (50, 100, 200, 400, 800, 1600):
        value, t = first_pass(n)
        trend.append({"n": n, "peak": s(value), "time": s(t)})
    airy = 2 * mpmath.quad(mpmath.airyai, [mpmath.airyaizero(1), -1, 0, 2, 6, 12, 20]) - 1
    mp.dps = 40
    late = mpmath.findroot(slope, mpf("157.917"))
    first = mpmath.findroot(lambda t: link1(t) + 1, mpf("53.152"))
    late4 = {"time": s(late), "peak": s(link1(late))}
    j11, j21 = mpmath.besseljzero(1, 1), mpmath.besseljzero(2, 1)
    mp.dps = 60
    return {
        "figure4": {"first_over": s(first), "first_pass": trend[0], "four_transits": late4},
        "figure5": {"first_over": s(j11 / 2), "time": s(j21 / 2), "peak": s(1 - 2 * mpmath.besselj(1, j21) / j21)},
        "airy": s(airy),
        "trend": trend,
        "all_time": [{"n": n, "bound": s(Paper(n).all_time(1))} for n in (50, 100, 200, 400)],
    }


def paper_link1(paper, t):
    return 2 / mpf(2 * paper.n + 1) * mpmath.fsum(
        (-1) ** j * sin(b) / (1 - cos(b)) * cos(b / 2) * cos(w * t)
        for j, (b, w) in enumerate(zip(paper.beta, paper.omega))
    )


if __name__ == "__main__":
    out = figures()
    print(json.dumps(out, indent=1), file=sys.stderr)
    out["values"] = []
    for n in (1, 2, 3, 5, 10, 50, 100, 300):
        out["values"].append(values(n))
        print(n, file=sys.stderr)
    with open(os.path.join(os.path.dirname(__file__), "paper.json"), "w") as file:
        json.dump(out, file)
