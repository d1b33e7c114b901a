#!/usr/bin/env bash
# Sets up, builds and passes all tests.
#
#   scripts/test.sh [ctest arguments ...]
#   scripts/test.sh --sanitize ...   under the address and undefined-behaviour sanitizers
#   scripts/test.sh --ci ...         with benchmark programs, experiments and the Python package
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
preset=release
case "${1:-}" in
  --sanitize) preset=asan; shift ;;
  --ci) preset=ci; shift ;;
  --help | -h) sed -n '2,6s/^# \{0,1\}//p' "$0"; exit 0 ;;
esac
if [ $preset = asan ]; then
  # LibTorch and Embree keep memory to the end of the process; leaks of ours are what the tests of
  # lte/base look for.
  export ASAN_OPTIONS=detect_leaks=0:detect_odr_violation=0 UBSAN_OPTIONS=print_stacktrace=1:halt_on_error=1
fi
scripts/setup.sh --tests
scripts/build.sh $preset
# Which tests ran and which skipped goes to a file a program; scripts/dev/check_skips.py reads them.
results=$PWD/$([ $preset = asan ] && echo build-asan || echo build)/test-results
rm -rf "$results"
# Two programs at a time: most of what they do takes one thread, and some wait for other processes.
ctest --preset $preset --parallel $(($(nproc) > 1 ? 2 : 1)) "$@"
[ $# -gt 0 ] || scripts/dev/check_skips.py "$results"
