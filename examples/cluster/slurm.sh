#!/usr/bin/env bash
# A study as a Slurm job array, a shard a task:
#
#   sbatch --array=1-16 examples/cluster/slurm.sh mission.ntg --from sets.csv -o study.csv
#   ntg merge study.csv
#
# A task that is preempted or runs into its limit is queued again and goes on from its journal.
#SBATCH --job-name=ntg
#SBATCH --cpus-per-task=1
#SBATCH --time=01:00:00
#SBATCH --requeue
#SBATCH --open-mode=append
set -euo pipefail

: "${SLURM_ARRAY_TASK_ID:?submit with sbatch --array=1-N}" "${SLURM_ARRAY_TASK_COUNT:?}"
exec ntg sweep "$@" --jobs 1 --shard "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT"
