#!/usr/bin/env bash
# SLURM job that runs a deck to its end, however many jobs that takes: before its time is over it writes a checkpoint
# and puts itself back into the queue, and goes on from there.
#
#   sbatch scripts/hpc/slurm.sh DECK [OPTIONS OF sgmp]
#   sbatch --nodes=4 --time=24:00:00 scripts/hpc/slurm.sh impact.inp --output "$SCRATCH/impact"
#
#SBATCH --job-name=sgmp
#SBATCH --nodes=1
#SBATCH --ntasks-per-node=2       # ranks: one per socket or NUMA domain
#SBATCH --cpus-per-task=16        # threads of each: the cores of that domain
#SBATCH --hint=nomultithread
#SBATCH --time=12:00:00
#SBATCH --signal=USR1@300         # seconds before the end; to the ranks, not to this script
#SBATCH --requeue
#SBATCH --open-mode=append
set -u
deck=${1:?usage: sbatch slurm.sh DECK [OPTIONS OF sgmp]}
shift

export OMP_NUM_THREADS=${SLURM_CPUS_PER_TASK:-1} OMP_PLACES=cores OMP_PROC_BIND=close
# The first time there is no checkpoint yet: then sgmp starts from the beginning.
srun --cpus-per-task="$OMP_NUM_THREADS" --cpu-bind=cores --kill-on-bad-exit=0 \
  "${SGMP:-sgmp}" "$deck" --quiet --restart latest "$@"
status=$?

# 6: stopped after a complete checkpoint. Everything else is an end, good or bad.
if [ "$status" -eq 6 ]; then
  scontrol requeue "$SLURM_JOB_ID"
fi
exit "$status"
