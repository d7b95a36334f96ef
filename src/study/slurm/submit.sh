#!/bin/bash
# Submits the study, or what of it is not done: the tasks, and after them the table.
set -eu
cd @DIR@
tasks=$(sbatch --parsable slurm/tasks.sh)
table=$(sbatch --parsable --dependency=afterany:"${tasks%%;*}" slurm/table.sh)
echo "submitted: tasks ${tasks%%;*}, table ${table%%;*}"
