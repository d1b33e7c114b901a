#!/usr/bin/env bash
# Tries the Debian packages of scripts/release.sh as a user has them: installs them by apt in a
# Debian of its own that has nothing else, renders the living room, and compiles the C example
# against lte-dev. Needs root and mmdebstrap, which it installs.
#
# usage: scripts/dev/try_packages.sh
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
fail() { echo "try_packages: $*" >&2; exit 1; }
packages=(out/release/lte_*.deb out/release/lte-dev_*.deb)
[ -e "${packages[0]}" ] || fail "no packages in out/release: run scripts/release.sh"
[ "$(id -u)" -eq 0 ] || fail "needs root, for chroot"
command -v mmdebstrap >/dev/null || apt-get install -y -qq --no-install-recommends mmdebstrap >/dev/null
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
# From where this system has its packages.
mmdebstrap --quiet --variant=apt --aptopt='APT::Install-Recommends "false"' bookworm "$root" \
  $(ls /etc/apt/sources.list /etc/apt/sources.list.d/* 2>/dev/null | grep -E '\.(list|sources)$')
mkdir "$root/packages"
cp "${packages[@]}" "$root/packages/"
begin=$SECONDS
chroot "$root" apt-get install -y -qq /packages/lte_*.deb >/dev/null
room=/usr/share/lte/assets/scenes/living_room.glb
render=(lte_render --quality draft --size 160x120 --quiet)
chroot "$root" "${render[@]}" $room --out /room.png
echo "try_packages: installed and rendered in $((SECONDS - begin)) s"
here=$(mktemp --suffix=.png)
out/release-build/bin/"${render[0]}" "${render[@]:1}" assets/scenes/living_room.glb --out "$here"
cmp "$root/room.png" "$here" || fail "the package's picture is not the build's own"
rm "$here"
chroot "$root" apt-get install -y -qq gcc libc6-dev cmake make /packages/lte-dev_*.deb >/dev/null
chroot "$root" cmake -S /usr/share/lte/examples/c -B /example >/dev/null
chroot "$root" cmake --build /example --target render_scene >/dev/null
chroot "$root" /example/render_scene $room /room.ppm
[ -s "$root/room.ppm" ] || fail "the C example made no picture"
echo "try_packages: all well"
