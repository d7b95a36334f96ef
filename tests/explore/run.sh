#!/usr/bin/env bash
# Drives the page of `asperity explore` in Debian's Chromium: bash tests/explore/run.sh PROGRAM [PICTURES]
# Exits 77, and says so, where there is no Chromium, no node, or its packages cannot be had.
set -euo pipefail
program="$(realpath "$1")"
pictures="${2:+$(realpath "$2")}"
here="$(cd "$(dirname "$0")" && pwd)"
root="$(cd "$here/../.." && pwd)"

skip() {
    echo "SKIPPED the page of asperity explore: $1" >&2
    exit 77
}
command -v "${ASPERITY_CHROMIUM:-/usr/bin/chromium}" >/dev/null || skip "there is no Chromium (apt-get install chromium)"
command -v node >/dev/null && command -v npm >/dev/null || skip "there is no node with npm"
# Beside what is built, where node finds them from the copied script.
work="$root/target/explore"
mkdir -p "$work"
cp "$here/package.json" "$here/package-lock.json" "$here/page.mjs" "$work"
cd "$work"
timeout 300 npm ci --no-audit --no-fund --silent >npm.log 2>&1 || skip "npm cannot install its packages: $(tail -1 npm.log)"
exec timeout 300 node page.mjs "$program" ${pictures:+"$pictures"}
