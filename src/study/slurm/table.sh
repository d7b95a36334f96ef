#!/bin/bash
#SBATCH --job-name=asperity-@NAME@-table
#SBATCH --open-mode=append
#SBATCH --output="@LOGS@/table.log"
@FEW@
# After all tasks, however they ended: makes study.csv of what there is, and says what is missing (75). Then submit.sh again computes that.
exec @PROGRAM@ study --merge @DIR@ --out @DIR@
