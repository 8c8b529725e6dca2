"""Step and pulse responses of a chain of masses and springs, to as many digits as are asked for.

    F_i(t) = F0_i + P [R_i(t) - R_i(t - D)],    R_i(t) = sum_j a_ij (1 - cos w_j t)

Eigenvalues come from bisection on Sturm counts of the link-force matrix A = B B^T, eigenvectors from inverse iteration,
both in `bits` of working precision, so that the squared condition number of A costs digits that are to spare. Every
decomposition is checked against two facts that it did not use: sum_j a_ij is the static share of spring i, and
sum_j a_ij w_j^2 is its first acceleration.

Peaks and first exceedances: branch and bound on intervals of time in double precision with phases reduced in extended
precision; what survives is polished by Newton's method in full precision.

A library for the scripts beside it. Needs: pip install gmpy2 numpy
"""

import json

import gmpy2
import numpy as np
from gmpy2 import mpfr


def digits(x, n=40):
    return gmpy2.mpfr(x).__format__(f".{n}g") if isinstance(x, float) else "{0:.{1}g}".format(x, n)


class Chain:
    """Masses and springs as plain floats, taken as exact."""

    def __init__(self, mass, stiffness, held_head=False, held_tail=False, bits=400):
        self.mass, self.stiffness = [float(m) for m in mass], [float(k) for k in stiffness]
        self.held_head, self.held_tail, self.bits = held_head, held_tail, bits
        gmpy2.get_context().precision = bits
        n = len(self.mass)
        assert len(self.stiffness) == n - 1
        held = lambda v: (v == 0 and held_head) or (v == n - 1 and held_tail)
        self.inv_mass = [mpfr(0) if held(v) else 1 / mpfr(m) for v, m in enumerate(self.mass)]
        self.k = [mpfr(x) for x in self.stiffness]

    def matrix(self):
        """Diagonal of A and squares of its off-diagonal."""
        k, im = self.k, self.inv_mass
        diagonal = [k[i] * (im[i] + im[i + 1]) for i in range(len(k))]
        square = [k[i] * k[i + 1] * im[i + 1] ** 2 for i in range(len(k) - 1)]
        return diagonal, square

    def eigenvalues(self):
        """All positive eigenvalues, ascending."""
        a, b2 = self.matrix()
        n = len(a)

        def below(x):
            d, count = a[0] - x, 0
            count += d < 0
            for i in range(1, n):
                if d == 0:
                    d = gmpy2.mpfr("1e-3000")
                d = a[i] - x - b2[i - 1] / d
                count += d < 0
            return count

        zeros = 1 if self.held_head and self.held_tail else 0
        top = max(a[i] + (gmpy2.sqrt(b2[i]) if i < n - 1 else 0) + (gmpy2.sqrt(b2[i - 1]) if i else 0) for i in range(n))
        top = top * (1 + mpfr(2) ** (20 - self.bits))
        bottom = top
        while below(bottom) > zeros:
            bottom = bottom / 2**10
        assert below(top) == n and below(bottom) == zeros
        known = {bottom: zeros, top: n}
        edges = [bottom, top]
        out = []
        for j in range(zeros, n):
            # The tightest bracket so far: shifts are shared between eigenvalues.
            lo = max(x for x in known if known[x] <= j)
            hi = min(x for x in known if known[x] > j)
            steps = 0
            while hi - lo > hi * mpfr(2) ** (16 - self.bits):
                x = gmpy2.sqrt(lo * hi) if hi > 2 * lo else (lo + hi) / 2
                c = below(x)
                steps += 1
                if steps < 60:
                    known[x] = c
                if c > j:
                    hi = x
                else:
                    lo = x
            out.append((lo + hi) / 2)
            known = {x: c for x, c in known.items() if c > j or x == lo or c == zeros}
            known[lo] = j
            known[top] = n
        return out

    def vector(self, eigenvalue):
        """A unit eigenvector, by inverse iteration."""
        a, b2 = self.matrix()
        n = len(a)
        b = [-gmpy2.sqrt(x) for x in b2]
        rng = np.random.default_rng(1)
        v = [mpfr(float(x)) for x in rng.uniform(0.5, 1.0, n) * rng.choice([-1, 1], n)]
        d, d_ok = [a[0] - eigenvalue], None
        for i in range(1, n):
            if d[-1] == 0:
                d[-1] = eigenvalue * mpfr(2) ** (-self.bits)
            d.append(a[i] - eigenvalue - b2[i - 1] / d[-1])
        if d[-1] == 0:
            d[-1] = eigenvalue * mpfr(2) ** (-self.bits)
        for _ in range(4):
            w = list(v)
            for i in range(1, n):
                w[i] = w[i] - b[i - 1] / d[i - 1] * w[i - 1]
            w[n - 1] = w[n - 1] / d[n - 1]
            for i in range(n - 2, -1, -1):
                w[i] = (w[i] - b[i] * w[i + 1]) / d[i]
            norm = gmpy2.sqrt(sum(x * x for x in w))
            v = [x / norm for x in w]
        return v

    def static(self, source):
        """Spring forces about which the motion under a unit forward force swings."""
        k, n = self.k, len(self.mass)
        m = [mpfr(x) for x in self.mass]
        s = source
        if self.held_head and self.held_tail:
            soft_front, soft_rear = sum(1 / x for x in k[:s]), sum(1 / x for x in k[s:])
            front, rear = -soft_rear / (soft_front + soft_rear), soft_front / (soft_front + soft_rear)
            return [front if i < s else rear for i in range(n - 1)]
        if self.held_head:
            return [mpfr(-1) if i < s else mpfr(0) for i in range(n - 1)]
        if self.held_tail:
            return [mpfr(0) if i < s else mpfr(1) for i in range(n - 1)]
        total = sum(m)
        return [-sum(m[: i + 1]) / total if i < s else sum(m[i + 1 :]) / total for i in range(n - 1)]

    def modes(self, source):
        """Frequencies and shares a_ij of a unit forward force on mass `source`, checked."""
        springs = len(self.k)
        root = [gmpy2.sqrt(x) for x in self.k]
        g = [mpfr(0)] * springs
        if source < springs:
            g[source] = root[source] * self.inv_mass[source]
        if source > 0:
            g[source - 1] = -root[source - 1] * self.inv_mass[source]
        values = self.eigenvalues()
        share = []
        for lam in values:
            u = self.vector(lam)
            push = sum(x * y for x, y in zip(u, g)) / lam
            share.append([root[i] * u[i] * push for i in range(springs)])
        static = self.static(source)
        for i in range(springs):
            total = sum(s[i] for s in share)
            first = sum(s[i] * lam for s, lam in zip(share, values))
            size = max(abs(s[i] * lam) for s, lam in zip(share, values))
            assert abs(total - static[i]) < 1e-45, (i, float(total - static[i]))
            assert abs(first - root[i] * g[i]) < mpfr("1e-45") * (size + 1), (i, float(first - root[i] * g[i]))
        return Modes([gmpy2.sqrt(x) for x in values], share)


class Modes:
    """w_j, and share[j][i]."""

    def __init__(self, omega, share):
        self.omega, self.share = omega, share


class Scene:
    def __init__(self, chain, source, force, duration, initial, rated_draft, rated_buff, horizon):
        gmpy2.get_context().precision = chain.bits
        self.chain, self.source = chain, source
        self.force, self.duration, self.horizon = float(force), float(duration), float(horizon)
        springs = len(chain.stiffness)
        spread = lambda x: [float(y) for y in x] if hasattr(x, "__len__") else [float(x)] * springs
        self.initial, self.rated_draft, self.rated_buff = spread(initial), spread(rated_draft), spread(rated_buff)
        self.modes = None

    def solve(self):
        if self.modes is None:
            self.modes = self.chain.modes(self.source)
        return self.modes

    def forces(self, t, springs=None, count=None):
        """[F, F', F''] of each spring at t, in full precision; of the `count` slowest modes if given."""
        m, t, p = self.solve(), mpfr(t), mpfr(self.force)
        springs = range(len(self.chain.k)) if springs is None else springs
        over = t >= self.duration
        coefficient = []
        for w in m.omega[:count]:
            s, c = gmpy2.sin_cos(w * t)
            row = [1 - c, w * s, w * w * c]
            if over:
                s, c = gmpy2.sin_cos(w * (t - mpfr(self.duration)))
                row = [x - y for x, y in zip(row, [1 - c, w * s, w * w * c])]
            coefficient.append(row)
        out = []
        for i in springs:
            f = [sum(a[i] * row[q] for a, row in zip(m.share, coefficient)) * p for q in range(3)]
            out.append([f[0] + mpfr(self.initial[i]), f[1], f[2]])
        return out

    def stretches(self):
        m, p = self.solve(), mpfr(self.force)
        springs = len(self.chain.k)
        static = self.chain.static(self.source)
        share = np.array([[float(a[i] * p) for a in m.share] for i in range(springs)]).reshape(springs, len(m.omega))
        step_end = min(self.duration, self.horizon)
        mean = [float(mpfr(f) + p * s) for f, s in zip(self.initial, static)]
        one = np.ones(len(m.omega))
        out = [Stretch(0.0, step_end, m.omega, share, np.array(mean), -one, 0 * one)]
        if self.duration < self.horizon:
            # From the pulse's end on, tau = t - D: cos(w tau) - cos(w tau + w D)
            sin_cos = [gmpy2.sin_cos(w * mpfr(self.duration)) for w in m.omega]
            c, s = np.array([float(1 - x[1]) for x in sin_cos]), np.array([float(x[0]) for x in sin_cos])
            out.append(Stretch(self.duration, self.horizon, m.omega, share, np.array(self.initial), c, s))
        return out

    def record(self, name, times, sides=True, margin=1e-10, springs=None):
        """The scene with its references, as plain data."""
        out = {
            "name": name,
            "mass": self.chain.mass,
            "stiffness": self.chain.stiffness,
            "held_head": self.chain.held_head,
            "held_tail": self.chain.held_tail,
            "source": self.source,
            "force": self.force,
            "duration": self.duration if np.isfinite(self.duration) else None,
            "initial": self.initial,
            "rated_draft": self.rated_draft,
            "rated_buff": self.rated_buff,
            "horizon": self.horizon,
            "values": [{"time": float(t), "force": [digits(f[0], 30) for f in self.forces(float(t))]} for t in times],
        }
        if sides:
            search = Search(self, margin)
            chosen = range(len(self.chain.k)) if springs is None else springs
            out["springs"] = [
                {"spring": i, "draft": search.side(i, 1.0), "buff": search.side(i, -1.0)} for i in chosen
            ]
        return out


class Stretch:
    """F = mean + sum_j share_ij (c_j cos(w_j tau) + s_j sin(w_j tau)), tau = t - from, in doubles."""

    def __init__(self, start, end, omega, share, mean, c, s):
        self.start, self.end, self.share, self.mean, self.c, self.s = start, end, share, mean, c, s
        self.omega = np.array([float(w) for w in omega])
        self.low = np.array([float(w - mpfr(float(w))) for w in omega])
        self.long = self.omega.astype(np.longdouble) + self.low.astype(np.longdouble)

    def waves(self, tau, count):
        """q and q' of the first `count` modes at times tau."""
        turn = np.longdouble("6.28318530717958647692528676655900577")
        x = np.multiply.outer(self.long[:count], np.asarray(tau, dtype=np.longdouble))
        x = (x - turn * np.rint(x / turn)).astype(float)
        cos, sin = np.cos(x), np.sin(x)
        c, s = self.c[:count, None], self.s[:count, None]
        return c * cos + s * sin, self.omega[:count, None] * (s * cos - c * sin)


class Search:
    """Global extremes and first exceedances of a scene."""

    CELLS = 400_000
    MANY = 200_000
    STOP = 0.2

    def __init__(self, scene, margin):
        self.scene, self.stretches = scene, scene.stretches()
        self.scale = max(max(scene.rated_draft), max(scene.rated_buff))
        self.margin = margin * self.scale
        self.first = [self.survey(s) for s in self.stretches]

    def survey(self, st):
        """Cells of the coarsest grid: bounds from the modes that it resolves, for every spring."""
        span = st.end - st.start
        count = len(st.omega)
        while count > 0 and span * st.omega[count - 1] / 1.2 > self.CELLS:
            count -= 1
        top = st.omega[count - 1] if count else 1.0 / span
        cells = int(np.ceil(span * top / 1.2)) + 1
        r = 0.5 * span / cells
        centre = (np.arange(cells) + 0.5) * (2 * r)
        f, d = [], []
        for block in np.array_split(centre, cells // 20_000 + 1):
            q, dq = st.waves(block, count)
            f.append(st.share[:, :count] @ q)
            d.append(st.share[:, :count] @ dq)
        return centre, r, count, np.concatenate(f, axis=1) + st.mean[:, None], np.concatenate(d, axis=1)

    def amplitude(self, st, i):
        return np.abs(st.share[i]) * np.hypot(st.c, st.s)

    def over(self, st, i, sign, f, d, r, count):
        """Upper bound of sign F over cells of half width r."""
        a = self.amplitude(st, i)
        second = np.sum(a[:count] * st.omega[:count] ** 2)
        return sign * f + np.abs(d) * r + 0.5 * second * r * r + a[count:].sum() + 1e-13 * a.sum()

    def refine(self, st, i, sign, cells, r, keep):
        """Splits cells until every mode that matters is resolved; `keep(upper, value, centre, r)` says which live on."""
        top = self.fastest(st, i)[0]
        value = np.zeros(0)
        for _ in range(200):
            if len(cells) == 0 or r * top < self.STOP:
                break
            cells = (cells[:, None] + r * np.array([-2 / 3, 0, 2 / 3])).ravel()
            r /= 3
            count = int(np.searchsorted(st.omega, 1.0 / r))
            f, d, value = self.at(st, i, cells, count)
            upper = self.over(st, i, sign, f, d, r, count)
            live = keep(upper, sign * value, cells, r)
            cells, value, upper = cells[live], value[live], upper[live]
            if len(cells) > self.MANY:
                # Millions of equal swings: follow the most promising, and remember what the others might reach.
                order = np.argsort(-upper)
                self.dropped = max(self.dropped, upper[order[self.MANY // 4]])
                cells, value = cells[order[: self.MANY // 4]], value[order[: self.MANY // 4]]
        value = self.at(st, i, cells, 0)[2] if len(cells) else np.zeros(0)
        return cells, r, value

    def at(self, st, i, cells, count):
        """Resolved F and F', and the whole F, at the cells' centres."""
        row, f, d, value = st.share[i], [], [], []
        for block in np.array_split(cells, len(cells) * len(row) // 2_000_000 + 1):
            q, dq = st.waves(block, len(row))
            f.append(row[:count] @ q[:count])
            d.append(row[:count] @ dq[:count])
            value.append(row @ q)
        mean = st.mean[i]
        return np.concatenate(f) + mean, np.concatenate(d), np.concatenate(value) + mean

    def side(self, i, sign):
        """The largest sign F with its time, and the first time over the rating with the slope there."""
        rating = self.scene.rated_draft[i] if sign > 0 else self.scene.rated_buff[i]
        self.dropped = -np.inf
        best, at = self.largest(i, sign)
        out = {"peak": digits(best), "time": digits(at, 25)}
        unknown = 2 * max(self.fastest(st, i)[1] for st in self.stretches)
        unknown = max(unknown, self.dropped - float(best))
        if unknown > 1e-15 * self.scale:
            out["uncertainty"] = f"{unknown:.2e}"
        if best > rating:
            self.dropped = -np.inf
            t, slope = self.crossing(i, sign, rating, float(at))
            assert self.dropped < rating, "an earlier crossing may have been dropped"
            out["first_over"], out["slope"] = digits(t, 25), digits(slope, 10)
        return out

    def largest(self, i, sign):
        best = mpfr(self.scene.initial[i]) * sign
        at = mpfr(0)
        seen = [float(best)]
        for st, (centre, r, count, f, d) in zip(self.stretches, self.first):
            upper = self.over(st, i, sign, f[i], d[i], r, count)
            # What is certainly reached: the value at the most promising centres.
            promising = centre[np.argsort(-upper)[:50]]
            seen.append(float(np.max(sign * self.at(st, i, promising, len(st.omega))[2])))
            cells = centre[upper > max(seen) - self.margin]

            def keep(upper, value, cells, r):
                seen.append(float(value.max()))
                return upper > max(seen) - self.margin

            cells, r, value = self.refine(st, i, sign, cells, r, keep)
            tops = self.tops(st, i, sign, np.sort(cells), r)
            for value, start in tops[:20]:
                if value < tops[0][0] - 1e-12 * self.scale:
                    break
                t, top = self.polish(st, i, sign, start + st.start, self.fastest(st, i)[2])
                if top > best:
                    best, at = top, t
            for t in (st.start, st.end):
                top = sign * self.scene.forces(t, [i])[0][0]
                if top > best:
                    best, at = top, mpfr(t)
        return best, at

    def fastest(self, st, i):
        """The fastest mode that is resolved, the joint amplitude of those beyond, and how many are resolved.

        A spring that stands still, but for millions of swings of 1e-12, has its peak to 1e-10 and no better.
        """
        a = self.amplitude(st, i)
        beyond = np.concatenate([np.cumsum(a[::-1])[::-1], [0.0]])
        for least in (1e-16, 1e-10):
            count = int(np.argmax(beyond <= least * self.scale))
            top = st.omega[count - 1] if count else 1.0 / (st.end - st.start)
            if (st.end - st.start) * top < 1e5:
                return top, beyond[count], count
        count = int(np.argmax(beyond <= 1e-16 * self.scale))
        return st.omega[count - 1], beyond[count], count

    def tops(self, st, i, sign, cells, r):
        """Local maxima of sign F near the cells, by Newton's method in doubles, the largest first."""
        if len(cells) == 0:
            return []
        value = sign * self.at(st, i, cells, 0)[2]
        left = np.concatenate([[True], (value[1:] >= value[:-1]) | (np.diff(cells) > 3 * r)])
        right = np.concatenate([(value[:-1] >= value[1:]) | (np.diff(cells) > 3 * r), [True]])
        start = cells[left & right]
        # Beyond the resolved modes the slope is one of swings that are too small to count.
        count = self.fastest(st, i)[2]
        tau, row = start, st.share[i][:count]
        for _ in range(4):
            step = []
            for block in np.array_split(tau, len(tau) * len(row) // 2_000_000 + 1):
                q, dq = st.waves(block, count)
                second = -((row * st.omega[:count] ** 2) @ q)
                slope = row @ dq
                step.append(np.where(sign * second < 0, -slope / np.where(second == 0, 1, second), 0))
            tau = np.clip(tau + np.clip(np.concatenate(step), -r, r), np.maximum(start - 3 * r, 0), start + 3 * r)
        tau = np.minimum(tau, st.end - st.start)
        value = sign * self.at(st, i, tau, 0)[2]
        return sorted(zip(value.tolist(), tau.tolist()), reverse=True)

    def polish(self, st, i, sign, start, count=None):
        t = mpfr(float(start))
        for _ in range(12):
            f, d, dd = self.scene.forces(t, [i], count)[0]
            if sign * dd >= 0:
                break
            step = d / dd
            t = min(max(t - step, mpfr(st.start)), mpfr(st.end))
            if abs(step) < mpfr("1e-45") * (abs(t) + mpfr("1e-30")):
                break
        return t, sign * self.scene.forces(t, [i])[0][0]

    def crossing(self, i, sign, rating, peak_at):
        if sign * self.scene.initial[i] > rating:
            return mpfr(0), mpfr(0)
        for st, (centre, r, count, f, d) in zip(self.stretches, self.first):
            upper = self.over(st, i, sign, f[i], d[i], r, count)
            end = [min(st.end, peak_at) - st.start]
            if end[0] < 0:
                continue
            # Doubles can say that a value is over the rating only beyond their own rounding.
            sure = rating + 1e-12 * self.scale
            cells = centre[(upper > rating) & (centre - r <= end[0])]

            def keep(upper, value, cells, r):
                over = cells[value > sure]
                if len(over):
                    end[0] = min(end[0], over.min())
                return (upper > rating) & (cells - r <= end[0])

            cells, r, value = self.refine(st, i, sign, cells, r, keep)
            value_at = lambda t: sign * self.scene.forces(t, [i])[0][0]
            hi = mpfr(float(end[0])) + mpfr(st.start)
            order = np.argsort(cells)
            inner = [g for g in np.split(order, np.nonzero(np.diff(cells[order]) > 3 * r)[0] + 1) if len(g)]
            for g in inner:
                # A peak that passes the rating by less than the cells can show.
                top = cells[g[np.argmax(sign * value[g])]]
                if abs(sign * value[g].max() - rating) > 1e-12 * self.scale and top + st.start < hi:
                    t, best = self.polish(st, i, sign, top + st.start)
                    if best > rating and t < hi:
                        hi = t
                        break
            if value_at(hi) <= rating:
                continue
            step = mpfr(float(r)) / 4
            lo = hi
            while lo > st.start and value_at(lo) > rating:
                hi, lo = lo, max(lo - step, mpfr(st.start))
            for _ in range(30):
                mid = (lo + hi) / 2
                lo, hi = (lo, mid) if value_at(mid) > rating else (mid, hi)
            t = (lo + hi) / 2
            for _ in range(8):
                f, d, _ = self.scene.forces(t, [i])[0]
                t = t - (sign * f - rating) / (sign * d)
            return t, sign * self.scene.forces(t, [i])[0][1]
        raise AssertionError("no crossing found")


def write(path, data):
    with open(path, "w") as out:
        out.write("[\n" + ",\n".join(json.dumps(x) for x in data) + "\n]\n")
