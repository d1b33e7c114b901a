#!/usr/bin/env bash
# Installs a build tree to a scratch prefix, then configures, builds and runs a project that finds it there.
#   tests/install/run.sh BUILD_DIR
set -euo pipefail
build=$1
source=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cmake --install "$build" --prefix "$scratch/prefix" >/dev/null
cmake -S "$source" -B "$scratch/build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$scratch/prefix" >/dev/null
cmake --build "$scratch/build" >/dev/null
[ "$("$scratch/build/consumer")" = "test 2" ]
"$scratch/prefix/bin/lte_train" --version
