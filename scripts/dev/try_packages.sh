#!/usr/bin/env bash
# Tries the packages of scripts/release.sh as users have them, each in a Debian 12 of its own that
# has nothing else: apt installs lte, whose demo must be the build's own picture, and lte-dev, with
# which the C example is compiled; pip installs the wheel, offline, whose demo must be the same.
#
# usage: scripts/dev/try_packages.sh [SECONDS]
#
# SECONDS  what installing and rendering may take in each, without downloads; 120 by default
#
# Needs root, and mmdebstrap, which it installs. Without these, or where Debian's packages cannot be
# reached, a line says so and nothing is tried. Steps that hang end after ten minutes.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
case "${1:-}" in
  --help | -h) sed -n '2,10s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;;
  -* | *[!0-9]*) echo "try_packages: unknown argument $1; see --help" >&2; exit 2 ;;
esac
limit=${1:-120}
fail() { echo "try_packages: $*" >&2; exit 1; }
debs=(out/release/lte_*.deb out/release/lte-dev_*.deb)
[ -e "${debs[0]}" ] || fail "no packages in out/release: run scripts/release.sh"
skip() { echo "try_packages: skipped: $*"; exit 0; }
[ "$(id -u)" -eq 0 ] || skip "needs root, for chroot"
command -v mmdebstrap >/dev/null || { apt-get update -qq &&
  apt-get install -y -qq --no-install-recommends mmdebstrap >/dev/null; } || skip "no mmdebstrap"

work=$(mktemp -d)
chmod 755 "$work"
trap 'rm -rf "$work"' EXIT
# With /proc, which programs find their own place by, mounted for the one command.
in_root() {
  DEBIAN_FRONTEND=noninteractive timeout 600 unshare --mount \
    sh -c 'mount --bind /proc "$1/proc" && exec chroot "$@"' sh "$work/$root" "$@"
}
install() {
  in_root apt-get install -y -qq "$@" >"$work/log" 2>&1 && return
  cat "$work/log"
  fail "apt-get install $*"
}
fetch() { install --download-only "$@"; }
# PICTURE: made since `begin`, and the same as the build's own.
check() {
  local took=$((SECONDS - begin))
  cmp "$work/$root/room.png" "$work/room.png" || fail "$1: its picture is not the build's own"
  [ "$took" -le "$limit" ] || fail "$1: $took s to install and render, more than $limit"
  echo "try_packages: $1: installed and rendered in $took s"
}

# From where this system has its packages. The lists stay: without them apt knows no package.
timeout 600 mmdebstrap --quiet --variant=apt --skip=cleanup/apt/lists \
  --aptopt='APT::Install-Recommends "false"' bookworm "$work/deb" \
  $(ls /etc/apt/sources.list /etc/apt/sources.list.d/* 2>/dev/null | grep -E '\.(list|sources)$') ||
  skip "no Debian from mmdebstrap"
echo force-unsafe-io >"$work/deb/etc/dpkg/dpkg.cfg.d/try"  # nothing there outlives this script
cp "${debs[0]}" "$work/deb/lte.deb"
cp "${debs[1]}" "$work/deb/lte-dev.deb"
cp -a "$work/deb" "$work/wheel"

demo=(lte demo --quality draft --size 160x120 --quiet --set denoise=off --out)
"build-packages/bin/${demo[@]}" "$work/room.png"

root=deb
fetch /lte.deb
begin=$SECONDS
install /lte.deb
in_root "${demo[@]}" /room.png
check lte.deb
install gcc libc6-dev cmake make /lte-dev.deb
in_root cmake -S /usr/share/lte/examples/c -B /example >/dev/null
in_root cmake --build /example --target render_scene >/dev/null
in_root /example/render_scene /usr/share/lte/assets/scenes/living_room.glb /room.ppm
[ -s "$work/deb/room.ppm" ] || fail "the C example made no picture"
echo "try_packages: lte-dev.deb: compiled the C example"

wheels=(out/release/lte-*-cp311-*.whl)
[ -e "${wheels[0]}" ] || { echo "try_packages: no wheel in out/release"; exit 0; }
root=wheel
install python3-venv
mkdir "$work/wheel/wheels"
cp "${wheels[0]}" "$work/wheel/wheels/"
python3 -m pip download -q --disable-pip-version-check --only-binary=:all: --python-version 3.11 \
  --no-deps -d "$work/wheel/wheels" numpy
begin=$SECONDS
in_root python3 -m venv /venv
in_root /venv/bin/pip install -q --no-index --find-links /wheels lte
in_root "/venv/bin/${demo[@]}" /room.png
check wheel
