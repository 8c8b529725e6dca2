"""What the Python package costs beside the computing: python3 tests/scale/python_overhead.py, where the wheel of a release build is
installed. Times are the least of several runs."""

import time

import trainsafe

SMALL = {
    "coupler": {"stiffness": "30 MN/m", "rated_load": "1.5 MN"},
    "vehicle": [{"count": 3, "mass": "80 t"}],
    "load": {"uniform": "0.5 MN"},
    "scenario": [{"kind": "break", "coupler": 2}],
}


def least(work, runs):
    times = []
    for _ in range(runs):
        start = time.perf_counter()
        result = work()
        times.append(time.perf_counter() - start)
    return min(times), result


small = trainsafe.Train.from_dict(SMALL)
seconds, analysis = least(lambda: trainsafe.analyze(small), 2000)
inside = analysis.cases.to_dict()["run_time_s"][0]
print(f"a train of 3 vehicles: {1e3 * seconds:.3f} ms a call, of which {1e3 * inside:.3f} ms computing")
seconds, _ = least(lambda: small.replace("load.uniform", "0.4 MN"), 500)
print(f"replace: {1e3 * seconds:.3f} ms")
ore = trainsafe.Train.from_dict({**SMALL, "vehicle": [{"count": 141, "mass": "80 t"}], "scenario": None})
seconds, analysis = least(lambda: trainsafe.analyze(ore), 2)
print(f"140 breaks: {seconds:.2f} s")
seconds, table = least(lambda: analysis._findings.couplers(), 10)
print(f"{len(table)} rows as Arrow: {1e3 * seconds:.1f} ms")
for name in ("to_pandas", "to_polars"):
    try:
        seconds, frame = least(lambda: getattr(trainsafe.Table(analysis._findings.couplers()), name)(), 10)
        print(f"{len(frame)} rows, {name}: {1e3 * seconds:.1f} ms")
    except ImportError as error:
        print(f"{name}: {error}")
