#!/bin/bash
#SBATCH --job-name=asperity-@NAME@
#SBATCH --array=1-@TASKS@@AT_ONCE@
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --signal=B:USR1@@WARNING@
#SBATCH --output="@LOGS@/task-%a.log"
@ALL@
# One share of the study, and no more of it than is not done. May be submitted again at any time: see submit.sh.
share="${SLURM_ARRAY_TASK_ID:?this script is a task of a job array, see submit.sh}/@TASKS@"
echo "share $share, start $((${SLURM_RESTART_COUNT:-0} + 1)), on $(hostname), $(date)"

# Slurm tells the script, not the program, that time is nearly over; by SIGUSR1 unless somebody changed that above.
child=
trap '[ -z "$child" ] || kill -USR1 "$child"' USR1 USR2 XCPU TERM INT HUP
@PROGRAM@ study @STUDY@ --out @DIR@ --shard "$share" --resume --threads "${SLURM_CPUS_PER_TASK:-1}"@OPTIONS@ &
child=$!
wait "$child"
code=$?
# A signal to the script ends `wait` as well.
while kill -0 "$child" 2>/dev/null; do
    wait "$child"
    code=$?
done
if [ "$code" -gt 128 ]; then
    wait "$child" 2>/dev/null
    last=$?
    [ "$last" -eq 127 ] || code=$last
fi
echo "share $share ended with $code, $(date)"

# 75: interrupted, what was computed is kept. Above 128: killed, for memory perhaps. Back into the queue, but not for ever, and not if somebody cancelled it:
# the job is not running any more then.
most=1000
[ "$code" -eq 75 ] || most=3
if { [ "$code" -eq 75 ] || [ "$code" -gt 128 ]; } && [ "${SLURM_RESTART_COUNT:-0}" -lt "$most" ]; then
    # Not by SLURM_JOB_ID, which of one task is that of the whole array.
    task="${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID"
    if [ "$(squeue --noheader --job "$task" --format %T 2>/dev/null)" = RUNNING ]; then
        echo "share $share goes back into the queue"
        # It is this job that is ended by it.
        scontrol requeue "$task" && sleep 600
    fi
fi
exit "$code"
