#!/bin/sh
# GNU parallel starts SHARES processes on this machine, and each takes its share:
#     examples/batch/parallel.sh MANIFEST FOLDER SHARES [ARGUMENTS OF parallel…]
# With --sshloginfile HOSTS they run on the machines of a list, which mount the same folder.
set -eu
manifest=$1 folder=$2 shares=$3
shift 3
seq "$shares" | parallel "$@" \
    hshfit batch "$manifest" -o "$folder" --shard "{}/$shares" --threads 1 --quiet
hshfit batch "$manifest" -o "$folder" --merge
