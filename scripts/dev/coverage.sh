#!/usr/bin/env bash
# Which lines of the library the tests run: builds with counters, runs tests, prints a table.
#
# usage: scripts/dev/coverage.sh [--without-torch] [FOLDER ...]
#
#   FOLDER             folders of tests/, such as base scene; the table has lte/FOLDER (default:
#                      every test, and lte, datagen, train and infer)
#   --without-torch    build what needs no LibTorch alone
#
# Pages are in out/coverage/index.html. Needs gcovr (Debian: gcovr). A folder takes minutes, all of
# them hours, in build-coverage.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
configure=(--preset coverage)
declare -a folders=() filters=()
while [ $# -gt 0 ]; do
  case "$1" in
    --without-torch) configure+=(-DLTE_TORCH=OFF); shift ;;
    --help | -h) sed -n '2,12s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;;
    -*) echo "coverage: unknown flag $1; see --help" >&2; exit 2 ;;
    *)
      [ -f "tests/$1/CMakeLists.txt" ] || { echo "coverage: no folder tests/$1" >&2; exit 2; }
      folders+=("$1"); filters+=(--filter "lte/$1/"); shift ;;
  esac
done
command -v gcovr >/dev/null || { echo "coverage: gcovr is missing (apt-get install gcovr)" >&2; exit 2; }

cmake "${configure[@]}" >/dev/null
find build-coverage -name '*.gcda' -delete
mkdir -p out/coverage
if [ ${#folders[@]} = 0 ]; then
  cmake --build --preset coverage
  ctest --preset coverage
  filters=(--filter lte/ --filter datagen/ --filter train/ --filter infer/)
else
  targets=("${folders[@]/#/lte_}")
  cmake --build --preset coverage --target "${targets[@]/%/_test}"
  ctest --preset coverage -R "^($(IFS='|'; echo "${folders[*]}"))\$"
fi
gcovr --root . "${filters[@]}" --exclude-unreachable-branches --print-summary \
  --txt - --html-details out/coverage/index.html build-coverage
