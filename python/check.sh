#!/usr/bin/env bash
# The Python package: lints, a wheel without optimisation, and the tests, doctests and notebooks on it as installed.
# Needs python3 with venv and pip; what is installed goes to target/python.
set -euo pipefail
cd "$(dirname "$0")/.."

cargo fmt --check --package trainsafe-python
cargo clippy --package trainsafe-python -- -D warnings

venv=target/python
if [ ! -x $venv/bin/python ]; then
    python3 -m venv $venv || { echo "python3 with venv is needed: install the distribution's python3-venv" >&2; exit 1; }
fi
python=$venv/bin/python
$python -m pip install --quiet --disable-pip-version-check "maturin>=1.9.4,<2" pytest numpy
# Tests of what needs these are skipped where they cannot be had.
for package in pandas pyarrow polars duckdb matplotlib pint "nbclient ipykernel nbformat" mypy; do
    # shellcheck disable=SC2086 # Several words are several packages.
    $python -m pip install --quiet --disable-pip-version-check $package ||
        echo "NOT CHECKED: $package cannot be installed, and what needs it is not tested" >&2
done

rm -rf target/wheels
$venv/bin/maturin build --quiet --locked --out target/wheels
$python -m pip install --quiet --disable-pip-version-check --force-reinstall --no-deps target/wheels/*.whl
$python -m pytest -q -p no:cacheprovider python/tests
$python -m pytest -q -p no:cacheprovider --doctest-modules --pyargs trainsafe
if [ -x $venv/bin/mypy ]; then
    $venv/bin/mypy --no-error-summary --ignore-missing-imports --cache-dir=target/mypy python/trainsafe
fi
