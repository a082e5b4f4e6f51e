#!/bin/sh
# Open MPI starts as many processes as it has slots, and each takes its share; they need not talk:
#     examples/batch/mpi.sh MANIFEST FOLDER [ARGUMENTS OF mpirun…]
set -eu
manifest=$1 folder=$2
shift 2
mpirun "$@" hshfit batch "$manifest" -o "$folder" --threads 1 --quiet
hshfit batch "$manifest" -o "$folder" --merge
