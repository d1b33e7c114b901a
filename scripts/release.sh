#!/usr/bin/env bash
# Makes what a release consists of, in out/release: Debian packages lte, lte-dev and lte-models, an
# archive of them, the Python wheels, the changelog's part, and SHA256SUMS. Training is in the wheel
# lte-torch. LTE_MAINTAINER="Name <address>" is the packages' maintainer, by default git's user.
#
# usage: scripts/release.sh [--no-wheel]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
wheel=1
case "${1:-}" in
  "") ;;
  --no-wheel) wheel= ;;
  --help | -h) sed -n '2,6s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;;
  *) echo "release: unknown argument $1; see --help" >&2; exit 2 ;;
esac
if [ -n "$wheel" ]; then scripts/setup.sh; else scripts/setup.sh --packages; fi
version=$(sed -n 's/^project(lte VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
out=out/release build=build-packages
export CCACHE_BASEDIR=$PWD  # as scripts/build.sh
rm -rf "$out" "$build/packages"
mkdir -p "$out"
cmake --preset packages >/dev/null
cmake --build --preset packages
(cd "$build" && cpack -B packages >/dev/null)
mv "$build"/packages/*.deb "$build"/packages/*.tar.gz "$out/"
if [ -n "$wheel" ]; then
  scripts/dev/wheel.sh
  cp out/wheel/*.whl "$out/"
fi
# Unreleased, until there is a part of this version.
awk -v part="## $version" '
  /^## / { on = index($0, part) == 1 || (!found && $0 == "## Unreleased"); found = found || on }
  on' CHANGELOG.md >"$out/CHANGES.md"
(cd "$out" && sha256sum -- * >SHA256SUMS)
echo "release: $out"
ls -sh "$out"
