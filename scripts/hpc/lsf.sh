#!/usr/bin/env bash
# LSF job that runs a deck to its end, however many jobs that takes: LSF warns it with SIGUSR1, it writes a checkpoint
# and ends with code 6, for which LSF puts it back into the queue (-Q).
#
#   DECK=impact.inp bsub < scripts/hpc/lsf.sh
#   DECK=impact.inp OPTIONS="--output $SCRATCH/impact" bsub -n 8 -W 24:00 < scripts/hpc/lsf.sh
#
#BSUB -J sgmp
#BSUB -n 2
#BSUB -R "span[ptile=2] affinity[core(16):distribute=balance]"
#BSUB -W 12:00
#BSUB -wa USR1
#BSUB -wt 5
#BSUB -Q 6
#BSUB -env "all"
set -u
: "${DECK:?DECK=file.inp bsub < lsf.sh}" "${OPTIONS:=}"

export OMP_NUM_THREADS=${OMP_NUM_THREADS:-16} OMP_PLACES=cores OMP_PROC_BIND=close
# mpirun hands SIGUSR1 on to the ranks. OPTIONS is a list of words.
# shellcheck disable=SC2086
exec mpirun --map-by "slot:PE=$OMP_NUM_THREADS" --bind-to core \
  "${SGMP:-sgmp}" "$DECK" --quiet --restart latest $OPTIONS
