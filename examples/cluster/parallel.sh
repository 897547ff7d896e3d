#!/usr/bin/env bash
# A study by GNU parallel, a shard a job, on this machine's cores or, with PARALLEL="--sshlogin ...", on others that
# see the same folder under the same name; at most three times each, and merges:
#
#   examples/cluster/parallel.sh 16 mission.ntg --from sets.csv -o study.csv
set -euo pipefail

shards="$1"
shift
output=
for ((i = 1; i < $#; i++)); do
    case "${!i}" in -o | --output) next=$((i + 1)) && output="${!next}" ;; esac
done
: "${output:?the words of ntg sweep have -o TABLE}"

# Without --workdir a login would begin in its home.
parallel --workdir . --retries 3 --quote ntg sweep "$@" --jobs 1 --shard "{}/$shards" ::: $(seq "$shards")
ntg merge "$output"
