#!/usr/bin/env bash
# Builds the wheel, installs it into a fresh environment and tests it there. Where there is no Python,
# venv or pip, or nothing can be downloaded, it says that it skips; with ASPERITY_REQUIRE_PYTHON=1 it
# fails. The wheel is the one that a release has, for any Linux of the last years (manylinux), compiled
# as the tests are, so that the dependencies are compiled once.
set -euo pipefail
cd "$(dirname "$0")/../.."

skip() {
    echo "SKIPPED the Python package: $1" >&2
    [ "${ASPERITY_REQUIRE_PYTHON:-0}" != 1 ] || exit 1
    exit 0
}

place=target/python-package
python="$place/venv/bin/python"
rm -rf "$place"
mkdir -p "$place"
command -v python3 >/dev/null || skip "there is no python3"
python3 -c 'import sys; sys.exit(sys.version_info < (3, 10))' || skip "$(python3 --version) is older than 3.10"
python3 -m venv "$place/venv" 2>"$place/log" || skip "python3 -m venv fails: $(tail -1 "$place/log")"
pip() { timeout 300 "$python" -m pip --disable-pip-version-check --quiet "$@"; }
pip install "maturin>=1.9,<2" numpy pytest matplotlib pandas meshio nbclient ipykernel mypy 2>"$place/log" || skip "pip cannot install: $(tail -1 "$place/log")"

export PATH="$PWD/$place/venv/bin:$PATH"
timeout 3600 maturin build --quiet --profile dev --manifest-path python/Cargo.toml --out "$place"
ls "$place"/asperity-*-manylinux_*.whl >/dev/null || { echo "the wheel is not for any Linux: $(ls "$place"/*.whl)" >&2; exit 1; }
pip install --no-index --no-deps "$place"/asperity-*.whl
# Not from python/, where the sources would be imported.
cd "$place"

# What the page of the documents says to a newcomer: an environment with nothing but the wheel and what it asks for, and one block of the page.
python3 -m venv newcomer
wheel=$(ls asperity-*.whl)
timeout 300 newcomer/bin/python -m pip install --quiet --disable-pip-version-check "./$wheel[plot]"
rm -f forces.png
awk '/^```python$/ { inside = 1; next } /^```$/ && inside { exit } inside' ../../docs/python.md >block.py
MPLBACKEND=agg newcomer/bin/python block.py
# It carries the program.
newcomer/bin/asperity law predict built-in --E 200e3 --nu 0.3 --yield 400 --mu 0.3 --h 0.02 >predicted.csv
[ "$(wc -l <predicted.csv)" -gt 20 ] || { echo "the program of the wheel predicts nothing" >&2; exit 1; }
[ -s forces.png ] || { echo "the first block of docs/python.md has drawn no forces.png" >&2; exit 1; }

exec venv/bin/python -m pytest -q --rootdir ../../python -p no:cacheprovider ../../python/tests
