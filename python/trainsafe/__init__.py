"""Which couplers of a train exceed their capacity, and when, after another coupler breaks or a shock hits the train.

>>> import trainsafe
>>> train = trainsafe.read("trains/ore-train.toml")
>>> analysis = trainsafe.analyze(train.replace("load.uniform", "0.8 MN"))
>>> analysis.couplers.columns[-1]
'first_passage_exceeds'

Forces are in newtons, draft positive; times in seconds after the event; vehicles and couplers count from 1 at the head.
"""

from ._analysis import Analysis, Field, History, analyze
from ._errors import AnalysisError, InputError, Problem, TrainsafeError
from ._fleet import fleet
from ._native import __version__
from ._table import Table
from ._train import Doubt, Train, read

__all__ = [
    "Analysis",
    "AnalysisError",
    "Doubt",
    "Field",
    "History",
    "InputError",
    "Problem",
    "Table",
    "Train",
    "TrainsafeError",
    "__version__",
    "analyze",
    "fleet",
    "read",
]
