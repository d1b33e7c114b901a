#!/usr/bin/env bash
# Sets up, builds and passes all tests.   --sanitize: the debug preset too, under the address and undefined-behaviour sanitizers.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
usage() { echo "usage: scripts/test.sh [--sanitize] [ctest arguments ...]"; }
preset=release
case "${1:-}" in
  --sanitize) preset=debug; shift ;;
  --help | -h) usage; exit 0 ;;
esac
if [ $preset = debug ]; then
  # LibTorch and Embree keep memory to the end of the process; leaks of ours are what the tests of lte/base look for.
  export ASAN_OPTIONS=detect_leaks=0:detect_odr_violation=0 UBSAN_OPTIONS=print_stacktrace=1:halt_on_error=1
fi
scripts/setup.sh --tests
scripts/build.sh $preset
ctest --preset $preset "$@"
