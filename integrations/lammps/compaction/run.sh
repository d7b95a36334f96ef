#!/usr/bin/env bash
# From two hardening curves to the compaction picture: bash integrations/lammps/compaction/run.sh [OUT] [options of compact.py]
# Tables of each material and friction with the program, the plug-in, twelve compactions, figures.
set -euo pipefail
here="$(cd "$(dirname "$0")" && pwd)"
root="$(cd "$here/../../.." && pwd)"
out="${1:-$root/target/lammps/compaction}"
[ $# -eq 0 ] || shift
elements="${ELEMENTS:-6}"
mkdir -p "$out/tables"

. "$root/integrations/lammps/prepare.sh"
for material in copper steel; do
    for mu in 0.1 0.5; do
        table="$out/tables/$material-$mu"
        mkdir -p "$table"
        sed "s/^friction = .*/friction = $mu/" "$here/$material.toml" >"$table/plane.toml"
        # Between two spheres h is what both give way together.
        { awk '/^indentation = /{ $3 *= 2 } { print }' "$table/plane.toml"; printf '\n[opponent]\nequal = true\n'; } >"$table/pair.toml"
        for kind in plane pair; do
            [ ! -e "$table/$kind.asperity" ] || continue
            if "$program" law tabulate "$table/$kind.toml" --out "$table/$kind" --elements "$elements" --resume >"$table/$kind.txt" 2>&1; then
                "$program" law export "$table/$kind/law.json" --format c --out "$table/$kind-export" >/dev/null
                cp "$table/$kind-export/law.asperity" "$table/$kind.asperity"
            elif [ "$kind" = pair ]; then
                echo "no table of two spheres for $material, mu = $mu: that of a plane stands in (F_N some 3 % low)" >&2
            else
                cat "$table/$kind.txt" >&2
                exit 1
            fi
        done
    done
done
"$python" "$here/compact.py" "$work/asperityplugin.so" "$out/tables" "$out" "$@"
echo "pictures and tables in $out"
