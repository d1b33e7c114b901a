#!/usr/bin/env bash
# Configures and builds a preset after set-up.
#
#   scripts/build.sh [preset] [targets ...]     release, and everything in it, by default
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
preset=${1:-release}
shift || true
scripts/setup.sh
# ccache then takes files of another folder of lte, or of another build folder here, for the same.
export CCACHE_BASEDIR=$PWD
echo "build: preset $preset${1:+: $*}"
cmake --preset "$preset" >/dev/null
# A LibTorch file needs up to 1.5 GB while it compiles: as many jobs as there is memory for, at most
# one a core.
memory_jobs=$(awk '/MemAvailable/ {print int($2 / 1500000)}' /proc/meminfo)
jobs=$(nproc)
[ "$memory_jobs" -ge "$jobs" ] || jobs=$((memory_jobs > 0 ? memory_jobs : 1))
cmake --build --preset "$preset" --parallel "$jobs" ${1:+--target "$@"}
