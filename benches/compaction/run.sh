#!/usr/bin/env bash
# Dense compaction by the computed law and by LAMMPS' MDR: bash benches/compaction/run.sh OUT [--cells] [options of press.py]
# Tables of the materials with the program (ASPERITY_PROGRAM, or built), the plug-in, compactions, picture and tables. --cells: the finite elements of the cubic
# packings again, which do not depend on the law; without it those in cells.csv stand.
set -euo pipefail
here="$(cd "$(dirname "$0")" && pwd)"
root="$(cd "$here/../.." && pwd)"
out="${1:?OUT}"
shift
cells="$here/cells.csv"
again=
[ "${1:-}" != --cells ] || { again=1; shift; }
mkdir -p "$out"
. "$root/integrations/lammps/prepare.sh"
"$program" law export built-in "$here/metal.toml" --for lammps --out "$out/tables/metal" >/dev/null
"$program" law export built-in "$here/metal.toml" --set material.youngs_modulus=8e3 --for lammps --out "$out/tables/soft" >/dev/null
"$python" "$here/press.py" "$work/asperityplugin.so" "$out/tables" "$out" "$@"
if [ -n "$again" ]; then
    cells="$out/cells.csv"
    gcc -O3 -march=native -ffast-math "$here/cells.c" -o "$out/cells" -lm
    python3 "$here/cells.py" "$out/cells" "$cells"
fi
[ ! -e "$out/press.json" ] || "$python" "$here/figures.py" "$out" "$cells" | tee "$out/tables.md"
