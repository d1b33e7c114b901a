#!/usr/bin/env bash
# Fails where clang-format would change a tracked C++ or CUDA file, naming the lines.
#
# usage: scripts/dev/check_format.sh [--fix] [FILE ...]     (default: all tracked .h, .cpp, .cu)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
mode=(--dry-run --Werror)
case "${1:-}" in
  --fix) mode=(-i); shift ;;
  --help | -h) echo "usage: scripts/dev/check_format.sh [--fix] [FILE ...]"; exit 0 ;;
esac
files() {
  if [ $# -gt 0 ]; then
    printf '%s\0' "$@"
  else
    git ls-files -z '*.h' '*.cpp' '*.cu'
  fi
}
files "$@" | xargs -0 -r -n 16 -P "$(nproc)" "${CLANG_FORMAT:-clang-format}" "${mode[@]}" || {
  echo "format: run scripts/dev/check_format.sh --fix" >&2
  exit 1
}
echo "format: clang-format agrees"
