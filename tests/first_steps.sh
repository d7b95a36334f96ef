#!/usr/bin/env bash
# The first ten minutes of a user, by the commands of the README: install, a law's curve, what an engine needs, a simulation, and the law in LAMMPS:
#   bash tests/first_steps.sh
# The program is installed as a development build, which shares its dependencies with the tests; everything else is as on the page. LAMMPS comes from
# integrations/lammps/run.sh --build; where that cannot be had, the last step is skipped, and says so (exit code 77).
set -euo pipefail
root="$(cd "$(dirname "$0")/.." && pwd)"
scratch="$(mktemp -d)"
trap 'rm -rf "$scratch"' EXIT
began=$SECONDS
told() { echo "ok $((SECONDS - began)) s: $1"; }

cargo install --quiet --debug --path "$root" --root "$scratch/usr" --target-dir "${CARGO_TARGET_DIR:-$root/target}"
export PATH="$scratch/usr/bin:$PATH" ASPERITY_PROGRAM="$scratch/usr/bin/asperity"
[ "$(command -v asperity)" = "$scratch/usr/bin/asperity" ]
told "installed, $(asperity --version)"

# The blocks of the README as they stand there.
mkdir "$scratch/work"
cd "$scratch/work"
ln -s "$root/fixtures" fixtures
awk '/^```toml$/ { inside = 1; next } /^```$/ && inside { exit } inside' "$root/README.md" >spheres.toml
awk '/^```sh$/ { inside = 1; next } /^```$/ { inside = 0 } inside' "$root/README.md" |
    grep -v -e '^cargo install' -e '^bash tests/run.sh' | sed 's/^cargo run --release -- /asperity /' >commands.sh
[ "$(wc -l <commands.sh)" -ge 3 ] || { echo "the README has no commands" >&2; exit 1; }
bash -euo pipefail commands.sh >printed
[ "$(grep -c '^[01],' printed)" -gt 20 ] || { echo "no curve was predicted" >&2; exit 1; }
grep -q '^F_N0 ' printed && [ -s out/history.csv ] && [ -s out/plots/forces.svg ]
told "a curve, a law for an engine, a simulation"

(cd engine && cc -std=c99 -O2 main.c -o main -lm && ./main) | grep -q restitution
told "two spheres collide in C"

code=0
bash "$root/integrations/lammps/run.sh" --build >lammps.log 2>&1 || code=$?
if [ "$code" -ne 0 ]; then
    tail -3 lammps.log >&2
    exit "$code"
fi
asperity law export built-in spheres.toml --for lammps --out lammps
# shellcheck disable=SC1091
source "$root/target/lammps/venv/bin/activate"
(cd lammps && timeout 300 lmp -in in.asperity -var plugin "$root/target/lammps/asperityplugin.so" -log none >../lammps.log)
grep -q '^Total wall time' lammps.log
told "spheres poured, pressed and sheared in LAMMPS"
