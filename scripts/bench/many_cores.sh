#!/usr/bin/env bash
# many_cores.sh: how the solver gains from many cores, and what does not: seconds of every phase at 1, 2, 4, 8, 16
# threads, then at as many ranks of one thread. Needs bash and awk only, so that it also runs where nothing is
# installed. Settings are variables of the environment:
#
#   SGMP=build/release/sgmp DECKS="input scripts/bench" OUT=build/cores scripts/bench/many_cores.sh
#
# SGMP: the program. DECKS: folders with the decks. OUT: where runs.jsonl and table.txt go. COUNTS="1 2 4 8 16".
# BUDGET=220: seconds after which no further run is started. MPIRUN=mpirun: the launcher, '' for no ranks. SHORT=yes:
# a few steps of each scene, to try the script. SCENES="taylor spin block ranks rings blast": which, in this order;
# spin is taylor with threads that look 100 times longer for work before they give their core away.
# The 2 threads of a machine of 2 cores are as far as COUNTS goes there: counts above the cores are left out.
set -u
here=$(cd "$(dirname "$0")" && pwd)
SGMP=${SGMP:-$here/../../build/release/sgmp}
DECKS=${DECKS:-$here $here/../../input}
OUT=${OUT:-build/cores}
CORES=$(nproc)
COUNTS=${COUNTS:-1 2 4 8 16}
BUDGET=${BUDGET:-220}
MPIRUN=${MPIRUN-mpirun}
SHORT=${SHORT:-no}
SCENES=${SCENES:-taylor spin block ranks rings blast}
PLACE=${PLACE:-$OUT/place}   # of the runs; several gigabytes
export SGMP_THREADS=exact OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
mkdir -p "$OUT" "$PLACE"
: > "$OUT/runs.jsonl"
{ grep -m1 'model name' /proc/cpuinfo; echo "cores: $CORES"; grep MemTotal /proc/meminfo; uptime; df -h "$PLACE"
  "$SGMP" --version; } > "$OUT/machine.txt" 2>&1

deck() {
  local folder
  for folder in $DECKS; do [ -f "$folder/$1" ] && echo "$folder/$1" && return; done
  echo "many_cores: no deck $1 in $DECKS" >&2
}

# One run: NAME KIND (threads or ranks) COUNT DECK WORDS...; a line of runs.jsonl.
run() {
  local name=$1 kind=$2 count=$3 path began took status
  path=$(deck "$4"); shift 4
  [ "$count" -gt "$CORES" ] && return
  if [ $SECONDS -gt "$BUDGET" ]; then echo "no time for $name, $kind $count" | tee -a "$OUT/left_out.txt"; return; fi
  rm -rf "$PLACE/run"
  began=$(date +%s%N)
  if [ "$kind" = ranks ]; then
    OMP_NUM_THREADS=1 timeout 120 $MPIRUN -n "$count" --bind-to core "$SGMP" "$path" --quiet --threads 1 \
      --output "$PLACE/run" "$@" > "$OUT/last.txt" 2>&1
  else
    timeout 120 "$SGMP" "$path" --quiet --threads "$count" --output "$PLACE/run" "$@" > "$OUT/last.txt" 2>&1
  fi
  status=$?
  took=$(( ($(date +%s%N) - began)/1000000 ))
  if [ ! -f "$PLACE/run/summary.json" ]; then
    { echo "failed: $name, $kind $count, exit status $status"; head -c 2000 "$OUT/last.txt"; } \
      | tee -a "$OUT/left_out.txt"
    return
  fi
  awk -v name="$name" -v kind="$kind" -v count="$count" -v took="$took" '
    function value(line) { sub(/^[^:]*: */, "", line); sub(/,$/, "", line); return line }
    function key(line) { sub(/^ *"/, "", line); sub(/".*/, "", line); gsub(/[ -]/, "_", line); return line }
    BEGIN { printf "{\"scene\": \"%s\", \"%s\": %d, \"process_ms\": %d", name, kind, count, took }
    /^  "[a-z_]*": \{/ { part = key($0); next }
    /^  \}/ { part = ""; next }
    part == "phase_seconds" || part == "halo" || part == "balance" {
      printf ", \"%s_%s\": %s", part == "phase_seconds" ? "s" : part, key($0), value($0) }
    part == "" && (/^  "(particles|steps|solve_seconds|wall_seconds|cpu_seconds|ns_per_particle_step)":/ ||
                   /^  "(peak_memory_bytes|checksum|verdict)":/) {
      printf ", \"%s\": %s", key($0), value($0) }
    END { print "}" }' "$PLACE/run/summary.json" >> "$OUT/runs.jsonl"
  tail -n 1 "$OUT/runs.jsonl"
  rm -rf "$PLACE/run"
}

short() { if [ "$SHORT" = yes ]; then echo "$1"; else echo "$2"; fi; }

for scene in $SCENES; do
  for count in $COUNTS; do
    case $scene in
      taylor)
        run taylor threads "$count" taylor_bar.inp --set h="$(short 0.76 0.38)" \
          --set t_end="$(short 0.004 0.08)" ;;
      spin)
        GOMP_SPINCOUNT=100000 run spin threads "$count" taylor_bar.inp --set h="$(short 0.76 0.38)" \
          --set t_end="$(short 0.004 0.08)" ;;
      block) run block threads "$count" block.inp --set cells="$(short 16 48)" --set steps="$(short 10 100)" ;;
      rings) run rings threads "$count" rings.inp --set h="$(short 0.5 0.25)" --set t_end="$(short 0.05 0.5)" ;;
      blast) run blast threads "$count" tnt_contact.inp --set h="$(short 2 1)" --set t_end="$(short 0.001 0.003)" ;;
      ranks) [ -z "$MPIRUN" ] || run ranks ranks "$count" taylor_bar.inp --set h="$(short 0.76 0.3)" \
               --set t_end="$(short 0.002 0.01)" --set format=vtkhdf ;;
    esac
  done
done

# The table: a line per run, seconds; gain over the scene's run with one.
awk '
  function number(name,   text) {
    if (!match($0, "\"" name "\": [^,}]*")) return 0
    text = substr($0, RSTART, RLENGTH); sub(/^[^:]*: /, "", text); gsub(/"/, "", text); return text
  }
  BEGIN {
    print "| scene | particles | steps | threads or ranks | process (s) | gain | solve (s) | gain | momentum | stress" \
          " | grid" \
          " | contact | re-binning | halo | output | start | end | memory (MB) | checksum |"
    print "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|"
  }
  {
    scene = number("scene"); count = number("threads") + number("ranks")
    process = number("process_ms")/1000; solve = number("solve_seconds")
    if (!(scene in first)) { first[scene] = process; solved[scene] = solve }
    printf "| %s | %d | %d | %d | %.2f | %.2f | %.2f | %.2f | %.2f | %.2f | %.2f | %.2f | %.2f | %.2f | %.2f | %.2f |" \
           " %.2f | %.0f | %s |\n", scene, number("particles"), number("steps"), count, process,
           first[scene]/process, solve, solved[scene]/solve, number("s_momentum_sweep"), number("s_stress_sweep"),
           number("s_grid"), number("s_contact"), number("s_re_binning"), number("s_halo"), number("s_output"),
           number("s_start"), number("s_end"), number("peak_memory_bytes")/1e6, number("checksum")
  }' "$OUT/runs.jsonl" | tee "$OUT/table.txt"
rm -rf "$PLACE"
