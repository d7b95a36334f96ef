#!/usr/bin/env bash
# Makes the pictures of the README and the gallery anew, in a minute or two:
#   bash docs/pictures.sh [PROGRAM]
# Those of the page in the browser are made by tests/explore/run.sh, those of LAMMPS by the scripts that
# docs/dem-lammps.md names, those of the 240 cases by `asperity plot` (fixtures/law/README.md).
set -euo pipefail
cd "$(dirname "$0")/.."
program="${1:-target/release/asperity}"
program="$(realpath "$program")"
scratch="$(mktemp -d)"
trap 'rm -rf "$scratch"' EXIT

"$program" run fixtures/cases/ideal.toml --out "$scratch/ideal" -q
cp "$scratch/ideal/plots/forces.svg" "$scratch/ideal/plots/contact.svg" docs/
for name in ratio indentation pressure stick slip; do
    cp "$scratch/ideal/plots/$name.svg" docs/gallery/
done

{
    cat fixtures/cases/reversal.toml
    printf '\n[mesh]\nelements_per_contact_radius = 8\n\n[units]\nlength = "mm"\nforce = "N"\nstress = "MPa"\n'
} >"$scratch/reversal.toml"
"$program" run "$scratch/reversal.toml" --out "$scratch/cycle" -q
for name in forces indentation; do
    cp "$scratch/cycle/plots/$name.svg" "docs/gallery/cycle-$name.svg"
done

"$program" run fixtures/cases/equal.toml --out "$scratch/equal" -q
"$program" law predict built-in fixtures/cases/equal.toml >"$scratch/law.csv"
python3 docs/spheres.py "$scratch/equal/history.csv" "$scratch/equal/summary.json" "$scratch/law.csv" docs/spheres.svg

cp fixtures/law/collapse-normal.svg fixtures/law/collapse-tangential.svg docs/gallery/
"$program" --version >docs/gallery/version.txt
