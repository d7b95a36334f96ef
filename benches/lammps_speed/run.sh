#!/usr/bin/env bash
# What a contact costs in LAMMPS, by this law, Hertz and Mindlin's and MDR:
#     bash benches/lammps_speed/run.sh OUT [options of speed.py]
# Table with the program (ASPERITY_PROGRAM, or built), the plug-in, timed runs.
set -euo pipefail
here="$(cd "$(dirname "$0")" && pwd)"
root="$(cd "$here/../.." && pwd)"
out="${1:?OUT}"
shift
mkdir -p "$out"
. "$root/integrations/lammps/prepare.sh"
"$program" law export built-in "$root/fixtures/cases/equal.toml" --for lammps --out "$out/table" >/dev/null
"$python" "$here/speed.py" "$work/asperityplugin.so" "$out/table/equal.asperity" "$out" "$@"
