"""Tests of the installed package: `pytest python/tests` in an environment where the wheel is installed. Trains are those of the
repository; what needs another package is skipped where it is not there."""

import os
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture(autouse=True)
def in_repository(monkeypatch):
    monkeypatch.chdir(ROOT)


@pytest.fixture
def ore():
    import trainsafe

    return trainsafe.read("trains/ore-train.toml")


@pytest.fixture
def figure_4():
    import trainsafe

    return trainsafe.analyze("trains/paper-figure-4.toml")


def pytest_report_header():
    import trainsafe

    return f"trainsafe {trainsafe.__version__} from {os.path.dirname(trainsafe.__file__)}"
