#!/usr/bin/env bash
# Trains in several processes on this machine, as torchrun would, without Python.
#
#   scripts/launch.sh N build/bin/lte_train --config ... --out ...    N processes, one a GPU
#
# Cores are shared out among the processes (OMP_NUM_THREADS says otherwise). Rank 0 prints, the
# others only warn. When one fails the others are given half a minute to say why; Ctrl-C goes to all
# of them.
set -euo pipefail
usage() { echo "usage: scripts/launch.sh PROCESSES COMMAND [ARGUMENTS ...]"; }
case "${1:-}" in
  --help | -h) usage; exit 0 ;;
esac
[[ "${1:-}" =~ ^[1-9][0-9]*$ && $# -ge 2 ]] || { usage >&2; exit 2; }
readonly processes=$1
shift

free_port() {
  local port
  for _ in {1..100}; do
    port=$((20000 + RANDOM % 20000))
    (exec 3<>"/dev/tcp/127.0.0.1/$port") 2>/dev/null || { echo "$port"; return; }
  done
  echo "launch: no free port found; set MASTER_PORT" >&2
  return 1
}

export WORLD_SIZE=$processes MASTER_ADDR=127.0.0.1 MASTER_PORT=${MASTER_PORT:-$(free_port)}
cores=$(nproc)
export OMP_NUM_THREADS=${OMP_NUM_THREADS:-$((cores > processes ? cores / processes : 1))}
pids=()
stop() { kill "-$1" "${pids[@]}" 2>/dev/null || true; }
trap 'stop INT' INT
trap 'stop TERM' TERM
for ((rank = 0; rank < processes; rank++)); do
  quiet=()
  ((rank == 0)) || quiet=(--quiet)
  RANK=$rank LOCAL_RANK=$rank "$@" "${quiet[@]}" &
  pids+=($!)
done

status=0
killer=
trap '[ -z "$killer" ] || kill "$killer" 2>/dev/null || true' EXIT
while ((${#pids[@]} > 0)); do
  code=0 ended=
  wait -n -p ended "${pids[@]}" || code=$?
  [ -n "$ended" ] || continue  # a signal to this script, which its processes have got too
  still=()
  for pid in "${pids[@]}"; do [ "$pid" = "$ended" ] || still+=("$pid"); done
  pids=("${still[@]+"${still[@]}"}")
  if ((code != 0 && status == 0)); then
    status=$code
    (sleep 30 && kill -KILL "${pids[@]+"${pids[@]}"}" 2>/dev/null) &
    killer=$!
  fi
done
exit "$status"
