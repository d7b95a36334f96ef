#!/usr/bin/env bash
# What a contact costs in LAMMPS beside Hertz and Mindlin's law and MDR: bash benches/lammps_speed/run.sh OUT [options of speed.py]
# Table with the program (ASPERITY_PROGRAM, or built), the plug-in, timed runs.
set -euo pipefail
here="$(cd "$(dirname "$0")" && pwd)"
root="$(cd "$here/../.." && pwd)"
out="${1:?OUT}"
shift
work="${ASPERITY_LAMMPS_DIR:-$root/target/lammps}"
program="${ASPERITY_PROGRAM:-}"
if [ -z "$program" ]; then
    (cd "$root" && cargo build --quiet --release)
    program="$root/target/release/asperity"
fi
export ASPERITY_PROGRAM="$program"
mkdir -p "$out"
bash "$root/integrations/lammps/run.sh" --build
"$program" law export built-in "$root/fixtures/cases/equal.toml" --for lammps --out "$out/table" >/dev/null
export LD_LIBRARY_PATH="$work/venv/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}"
"$work/venv/bin/python" "$here/speed.py" "$work/asperityplugin.so" "$out/table/equal.asperity" "$out" "$@"
