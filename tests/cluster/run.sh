#!/usr/bin/env bash
# A study on a real Slurm on this machine, disturbed in every way that clusters know, against a plain run of it; then the same study by GNU parallel and by
# Snakemake. Installs Debian's packages where they are missing and there is the right to; what cannot be installed is skipped, and said.
#     bash tests/cluster/run.sh [PROGRAM]        (target/release/asperity, which is built if it is not there)
set -euo pipefail
cd "$(dirname "$0")/../.."

say() { echo "cluster: $*"; }
fail() { say "FAILED: $*" >&2; exit 1; }

as_root=()
if [ "$(id -u)" -ne 0 ]; then
    sudo -n true 2>/dev/null || { say "SKIPPED: Slurm's daemons need root here"; exit 0; }
    as_root=(sudo -n)
fi
install() {
    command -v "$1" >/dev/null && return 0
    command -v apt-get >/dev/null || return 1
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -qq -y --no-install-recommends "${@:2}" >/dev/null 2>&1 && return 0
    "${as_root[@]}" apt-get update -qq >/dev/null 2>&1 || true
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -qq -y --no-install-recommends "${@:2}" >/dev/null 2>&1
}
install slurmctld slurmctld slurmd slurm-client munge || { say "SKIPPED: no Slurm, and it cannot be installed"; exit 0; }

program=${1:-}
if [ -z "$program" ]; then
    cargo build --release --quiet
    program=target/release/asperity
fi
program=$(realpath "$program")

scratch=$(mktemp -d)
munged_started=
# The daemons end by the numbers that they left, and nothing else does.
stop_daemon() { [ -s "$scratch/$1.pid" ] && "${as_root[@]}" kill "$(cat "$scratch/$1.pid")" 2>/dev/null || true; }
clean_up() {
    code=$?
    if [ "$code" -ne 0 ]; then
        say "what the jobs said:" >&2
        tail -n 40 "$scratch"/slurm/slurm/*.log "$scratch"/slurmctld.log "$scratch"/slurmd.log >&2 2>/dev/null || true
    fi
    scancel --quiet --user "$(id -un)" 2>/dev/null || true
    stop_daemon slurmd
    stop_daemon slurmctld
    [ -z "$munged_started" ] || "${as_root[@]}" kill "$munged_started" 2>/dev/null || true
    sleep 1
    rm -rf "$scratch" 2>/dev/null || true
}
trap clean_up EXIT

# 24 cases of some seconds, less than a second each on a quiet machine.
cat > "$scratch/study.toml" <<'STUDY'
[base.sphere]
radius = 1.0
[base.material]
youngs_modulus = 200e3
poissons_ratio = 0.3
[base.material.hardening]
law = "ideal"
yield_stress = 400.0
[base.contact]
friction = 0.3
[base.mesh]
elements_per_contact_radius = 5
[base.solver]
press_steps = 30
[[base.path]]
indentation = 0.01
[[base.path]]
shear = 0.002
[grid]
"material.hardening.yield_stress" = [200.0, 400.0, 800.0, 1600.0]
"contact.friction" = [0.1, 0.3, "stick"]
"path.0.indentation" = [0.005, 0.01]
STUDY

# The rows without the time that they took, and the histories of all cases by what they are of.
digest() {
    python3 - "$1" <<'PYTHON'
import csv, hashlib, pathlib, sys
root = pathlib.Path(sys.argv[1])
rows = list(csv.DictReader(open(root / "study.csv")))
for row in rows:
    row.pop("cpu_s")
    print(sorted(row.items()), hashlib.sha256((root / row["directory"] / "history.csv").read_bytes()).hexdigest())
print(len(rows), sum(row["status"] == "done" for row in rows))
PYTHON
}

say "plain run"
"$program" study "$scratch/study.toml" --out "$scratch/plain" --device cpu -q
digest "$scratch/plain" > "$scratch/plain.digest"
[ "$(tail -n 1 "$scratch/plain.digest")" = "24 24" ] || fail "the plain run has not 24 cases"

say "starting munged, slurmctld and slurmd in $scratch"
if ! munge -n 2>/dev/null | unmunge >/dev/null 2>&1; then
    "${as_root[@]}" mkdir -p /run/munge /var/log/munge
    "${as_root[@]}" chown munge: /run/munge /var/log/munge
    [ -s /etc/munge/munge.key ] || "${as_root[@]}" /usr/sbin/mungekey --create >/dev/null 2>&1 || true
    if [ ${#as_root[@]} -gt 0 ]; then sudo -n -u munge /usr/sbin/munged; else setpriv --reuid munge --regid munge --clear-groups /usr/sbin/munged; fi
    munged_started=$(cat /run/munge/munged.pid)
    for _ in $(seq 50); do munge -n 2>/dev/null | unmunge >/dev/null 2>&1 && break; sleep 0.1; done
    munge -n | unmunge >/dev/null || fail "munged does not answer"
fi
mkdir -p "$scratch/state" "$scratch/spool"
chmod 755 "$scratch"
port=$((20000 + RANDOM % 20000))
cat > "$scratch/slurm.conf" <<CONF
ClusterName=test
SlurmctldHost=localhost
SlurmctldPort=$port
SlurmdPort=$((port + 1))
AuthType=auth/munge
MpiDefault=none
ProctrackType=proctrack/pgid
TaskPlugin=task/none
ReturnToService=2
SlurmUser=root
SlurmdUser=root
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
SlurmctldPidFile=$scratch/slurmctld.pid
SlurmdPidFile=$scratch/slurmd.pid
SlurmctldLogFile=$scratch/slurmctld.log
SlurmdLogFile=$scratch/slurmd.log
StateSaveLocation=$scratch/state
SlurmdSpoolDir=$scratch/spool
SchedulerParameters=sched_interval=2,sched_min_interval=200000,batch_sched_delay=0
KillWait=10
NodeName=localhost CPUs=2 RealMemory=1000 State=UNKNOWN
PartitionName=main Nodes=localhost Default=YES MaxTime=INFINITE State=UP
CONF
export SLURM_CONF="$scratch/slurm.conf"
start_slurmd() { "${as_root[@]}" env SLURM_CONF="$SLURM_CONF" slurmd -f "$SLURM_CONF" -N localhost; }
"${as_root[@]}" env SLURM_CONF="$SLURM_CONF" slurmctld -f "$SLURM_CONF"
start_slurmd
for _ in $(seq 100); do [ "$(sinfo --noheader --format %t 2>/dev/null)" = idle ] && break; sleep 0.2; done
[ "$(sinfo --noheader --format %t)" = idle ] || fail "the node is $(sinfo --noheader --format %t), not idle"

state() { squeue --noheader --job "$1" --format %T 2>/dev/null | head -n 1; }
wait_for() { # seconds, what, command
    local seconds=$1 what=$2
    shift 2
    for _ in $(seq $((5 * seconds))); do "$@" && return 0; sleep 0.2; done
    squeue >&2 || true
    fail "waited $seconds s for $what"
}
running() { [ "$(state "$1")" = RUNNING ]; }
answers() { scontrol ping 2>/dev/null | grep -q UP && sinfo --noheader --format %t 2>/dev/null | grep -qE '^(mix|alloc|idle)$'; }
gone() { [ -z "$(squeue --noheader --format %i 2>/dev/null)" ]; }
# Slurm holds what was requeued for two minutes, which a test has not.
all_gone() {
    for task in 1 2 4; do scontrol update "JobId=${array}_$task" StartTime=now >/dev/null 2>&1 || true; done
    gone
}
# The program that a task runs: the child of its script.
process_of() { pgrep -f -- "--out $out --shard $1/4 " | head -n 1; }
# A share that is to be disturbed stands still until then, however fast its cases are.
stopped() {
    local process
    process=$(process_of "$1")
    [ -n "$process" ] && kill -STOP "$process" 2>/dev/null
}

out=$scratch/slurm
say "asperity study --slurm --submit"
submitted=$("$program" study "$scratch/study.toml" --out "$out" --device cpu --slurm tasks=4 at-once=2 time=10 --submit)
echo "$submitted"
array=$(sed -n 's/.*tasks \([0-9]*\),.*/\1/p' <<< "$submitted")

wait_for 60 "share 1" stopped 1
wait_for 60 "share 2" stopped 2
say "killing the program of share 1 with -9"
kill -9 "$(process_of 1)"
say "requeueing share 2"
scontrol requeue "${array}_2"
wait_for 90 "share 3" stopped 3
wait_for 90 "share 4" stopped 4
say "restarting slurmd"
stop_daemon slurmd
sleep 1
start_slurmd
wait_for 90 "the node's return" answers
say "cancelling share 3"
scancel "${array}_3"
say "telling share 4 that its time is over"
scancel --signal=USR1 --batch "${array}_4"
sleep 1
kill -CONT "$(process_of 4)" || fail "share 4 was gone before its time"
wait_for 400 "the end of all jobs" all_gone
say "the table's job said:"
cat "$out/slurm/table.log"
grep -q "ended with 137" "$out/slurm/task-1.log" || fail "share 1 was not killed: $(cat "$out/slurm/task-1.log")"
grep -q "goes back into the queue" "$out/slurm/task-1.log" || fail "share 1 did not come back"
grep -q "ended with 75" "$out/slurm/task-4.log" || fail "share 4 was not interrupted: $(cat "$out/slurm/task-4.log")"
grep -q "start 2" "$out/slurm/task-4.log" || fail "share 4 did not come back"
! grep -q "start 2" "$out/slurm/task-3.log" || fail "share 3 came back though it was cancelled"
grep -q "cases are missing" "$out/slurm/table.log" || fail "the table's job does not say what is missing"

say "submitting again: what is left of the cancelled share"
bash "$out/slurm/submit.sh"
wait_for 240 "the end of all jobs" gone
tail -n 1 "$out/slurm/table.log"
digest "$out" > "$scratch/slurm.digest"
diff "$scratch/plain.digest" "$scratch/slurm.digest" || fail "the rows are not those of the plain run"
say "24 rows, those of the plain run, and 24 histories with its bits"

if install parallel parallel; then
    say "GNU parallel"
    parallel --will-cite --jobs 2 "$program" study "$scratch/study.toml" --out "$scratch/parallel" --shard {}/4 --resume --threads 1 --device cpu -q ::: 1 2 3 4
    "$program" study --merge "$scratch/parallel" --out "$scratch/parallel"
    digest "$scratch/parallel" | diff "$scratch/plain.digest" - || fail "GNU parallel: the rows are not those of the plain run"
else
    say "SKIPPED: GNU parallel cannot be installed"
fi

if command -v snakemake >/dev/null || { python3 -m venv "$scratch/venv" && timeout 300 "$scratch/venv/bin/pip" install --quiet --disable-pip-version-check snakemake; } >/dev/null 2>&1; then
    say "Snakemake"
    snakemake=$(command -v snakemake || echo "$scratch/venv/bin/snakemake")
    "$snakemake" --quiet --directory "$scratch" --snakefile docs/cluster/Snakefile --cores 2 --retries 3 \
        --config program="$program" study="$scratch/study.toml" out="$scratch/snake" shares=4 > "$scratch/snakemake.log" 2>&1 || { cat "$scratch/snakemake.log" >&2; fail "Snakemake"; }
    digest "$scratch/snake" | diff "$scratch/plain.digest" - || fail "Snakemake: the rows are not those of the plain run"
else
    say "SKIPPED: Snakemake cannot be installed"
fi
say "all green"
