#!/bin/sh
# Slurm array of 8 tasks, each of which takes its share of a manifest:
#     sbatch --array=1-8 examples/batch/slurm.sh MANIFEST FOLDER
# The number of the task and their count come from Slurm's environment. A task that is killed or
# whose node fails is started again and goes on where it was. Afterwards, anywhere:
#     hshfit batch MANIFEST -o FOLDER --merge
#SBATCH --job-name=hshfit
#SBATCH --cpus-per-task=1
#SBATCH --mem-per-cpu=2G
#SBATCH --requeue
set -eu
exec hshfit batch "$1" -o "$2" --threads "${SLURM_CPUS_PER_TASK:-1}" --quiet
