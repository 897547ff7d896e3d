#!/usr/bin/env bash
# A study as a HyperQueue task array, a shard a task, at most three times each; waits, and merges:
#
#   hq server start & hq worker start &
#   examples/cluster/hyperqueue.sh 16 mission.ntg --from sets.csv -o study.csv
set -euo pipefail

shards="$1"
shift
output=
for ((i = 1; i < $#; i++)); do
    case "${!i}" in -o | --output) next=$((i + 1)) && output="${!next}" ;; esac
done
: "${output:?the words of ntg sweep have -o TABLE}"

# HQ_TASK_ID is the number of the task.
hq submit --wait --cpus=1 --array="1-$shards" --crash-limit=3 -- \
    bash -c 'exec ntg sweep "${@:2}" --jobs 1 --shard "$HQ_TASK_ID/$1"' shard "$shards" "$@"
ntg merge "$output"
