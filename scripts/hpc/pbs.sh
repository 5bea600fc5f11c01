#!/usr/bin/env bash
# PBS job that runs a deck to its end, however many jobs that takes: before its time is over it writes a checkpoint,
# submits the next job, and ends.
#
#   qsub -v DECK=impact.inp scripts/hpc/pbs.sh
#   qsub -v DECK=impact.inp,OPTIONS="--output $SCRATCH/impact",LIMIT=23:50:00 -l walltime=24:00:00 scripts/hpc/pbs.sh
#
#PBS -N sgmp
#PBS -l select=1:ncpus=32:mpiprocs=2:ompthreads=16
#PBS -l walltime=12:00:00
#PBS -j oe
set -u
cd "$PBS_O_WORKDIR" || exit 2
: "${DECK:?submit with qsub -v DECK=file.inp}" "${OPTIONS:=}"
limit=${LIMIT:-11:50:00}          # less than the walltime above by what a checkpoint may take
ranks=${RANKS:-$(wc -l < "$PBS_NODEFILE")}

export OMP_NUM_THREADS=${OMP_NUM_THREADS:-1} OMP_PLACES=cores OMP_PROC_BIND=close
# PE: cores of each rank. OPTIONS is a list of words.
# shellcheck disable=SC2086
mpirun -n "$ranks" --map-by "slot:PE=$OMP_NUM_THREADS" --bind-to core \
  "${SGMP:-sgmp}" "$DECK" --quiet --restart latest --time-limit "$limit" $OPTIONS
status=$?

# 6: stopped after a complete checkpoint. Everything else is an end, good or bad.
if [ "$status" -eq 6 ]; then
  qsub -v "DECK=$DECK,OPTIONS=$OPTIONS,LIMIT=$limit" "${JOB_SCRIPT:-$0}"
fi
exit "$status"
