#!/usr/bin/env bash
# Drivers that have little: SwiftShader, the software driver of Chromium, which has no double precision;
# and each driver below a layer that lowers its limits to WebGPU's defaults, and below them, and loses its
# device. Usage: tests/drivers/run.sh PROGRAM. Ends with 77 where a driver or a compiler is missing.
set -euo pipefail
cd "$(dirname "$0")/../.."
program="$(realpath "$1")"

skip() {
    echo "SKIPPED drivers: $1" >&2
    exit 77
}

swiftshader="" lavapipe=""
for file in /usr/lib/chromium/vk_swiftshader_icd.json /usr/lib/chromium-browser/vk_swiftshader_icd.json; do
    [ -n "$swiftshader" ] || [ ! -e "$file" ] || swiftshader="$file"
done
for file in /usr/share/vulkan/icd.d/lvp_icd*.json; do
    [ ! -e "$file" ] || lavapipe="$file"
done
[ -n "$swiftshader" ] || skip "no SwiftShader (Debian and Ubuntu: chromium)"
[ -n "$lavapipe" ] || skip "no lavapipe (Debian and Ubuntu: mesa-vulkan-drivers)"
[ -e /usr/include/vulkan/vk_layer.h ] || skip "no headers of Vulkan (Debian and Ubuntu: libvulkan-dev)"
command -v gcc >/dev/null || skip "no gcc"

work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
cp tests/drivers/layer.json "$work"
gcc -O1 -Wall -Wextra -Werror -shared -fPIC tests/drivers/layer.c -o "$work/liblayer.so"
layer=(VK_LAYER_PATH="$work" VK_INSTANCE_LAYERS=VK_LAYER_asperity_tests)
unset ASPERITY_ADAPTER ASPERITY_DEVICE ASPERITY_GPU_MEMORY

# with DRIVER VARIABLE=VALUE... COMMAND...
with() {
    local driver="$1"
    shift
    timeout 240 env VK_DRIVER_FILES="$driver" VK_ICD_FILENAMES="$driver" "$@"
}

fail() {
    echo "tests/drivers/run.sh: $1" >&2
    exit 1
}

# simulate NAME EXPECTED_CODE DRIVER VARIABLE=VALUE... -- OPTIONS...: what it says is in $work/NAME.log.
simulate() {
    local name="$1" expected="$2" driver="$3" environment=() code=0
    shift 3
    while [ "$1" != -- ]; do
        environment+=("$1")
        shift
    done
    shift
    with "$driver" "${environment[@]}" "$program" run tests/drivers/case.toml --out "$work/$name" "$@" >"$work/$name.log" 2>&1 || code=$?
    [ "$code" -eq "$expected" ] || fail "$name: exit code $code, not $expected: $(cat "$work/$name.log")"
}

# agree NAME: its forces are the CPU's.
agree() {
    python3 - "$work/cpu/summary.json" "$work/$1/summary.json" <<'PYTHON' || fail "$1: other forces than on the CPU"
import json, sys
cpu, other = (json.load(open(path)) for path in sys.argv[1:])
for key in ("F_N0", "F_T_max"):
    print(f"{key}: {other[key]:.8g} on {other['device']}, {cpu[key]:.8g} on the CPU")
    assert abs(other[key] / cpu[key] - 1) < 1e-4, key
PYTHON
}

simulate cpu 0 "$lavapipe" A=B -- --device cpu
# As they are: in f32 with residuals checked in f64, and on the one that has it in f64.
simulate swiftshader 0 "$swiftshader" A=B -- --device gpu
agree swiftshader
simulate lavapipe 0 "$lavapipe" A=B -- --device gpu
agree lavapipe

defaults=(ASPERITY_LAYER_BUFFERS=8 ASPERITY_LAYER_RANGE=134217728)
for driver in "$swiftshader" "$lavapipe"; do
    # WebGPU's defaults are enough, whether double precision is there or not.
    simulate defaults 0 "$driver" "${layer[@]}" "${defaults[@]}" ASPERITY_LAYER_NO_F64=1 -- --device gpu --force
    agree defaults
    # Below them the limit is named with the kernel that needs more, before anything is computed.
    simulate threads 2 "$driver" "${layer[@]}" ASPERITY_LAYER_THREADS=128 -- --device gpu --force
    grep -q "needs 256 threads in one workgroup (.*), the adapter has 128" "$work/threads.log" || fail "$(cat "$work/threads.log")"
    simulate buffers 2 "$driver" "${layer[@]}" ASPERITY_LAYER_BUFFERS=7 -- --device gpu --force
    grep -q "needs 8 storage buffers in one kernel (.*), the adapter has 7" "$work/buffers.log" || fail "$(cat "$work/buffers.log")"
    # A device that is lost in mid-run ends the run with what was computed, and is told of.
    simulate lost 3 "$driver" "${layer[@]}" ASPERITY_LAYER_LOSE=40 -- --device gpu --force
    grep -qi "lost" "$work/lost.log" || fail "$(cat "$work/lost.log")"
done

# A short binding cuts the batch up, and it is printed how far.
with "$lavapipe" "${layer[@]}" ASPERITY_LAYER_RANGE=2097152 "$program" study tests/drivers/study.toml --out "$work/study" \
    --device gpu >"$work/study.log" 2>&1 ||
    fail "$(cat "$work/study.log")"
grep -rhqE "sees 2 MiB of an array: of [0-9]+ cases of a batch no more than [0-9]+ go at a time" "$work/study.log" "$work/study" ||
    fail "it is not said how far a batch is cut: $(cat "$work/study.log")"

# Kernels by themselves against the CPU, in f32, on the driver that the other tests do not have.
with "$swiftshader" ASPERITY_REQUIRE_GPU=1 cargo test --quiet --test conformance -- contact::gpu_f32 element::gpu_f32::forces_and_tangents_agree
