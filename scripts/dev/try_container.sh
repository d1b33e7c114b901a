#!/usr/bin/env bash
# Builds the Containerfile with buildah, without a daemon and without a registry: its two base
# images are made by mmdebstrap from where this system has its packages. Then renders the demo in
# the container, which must be the build's own picture.
#
# usage: scripts/dev/try_container.sh [--setup]
#
# --setup  also builds the stage setup, in which sources are compiled: 1.3 GB to fetch, ten minutes
#
# Needs root, and buildah and mmdebstrap, which it installs. Images and files lie in a folder that
# goes with the script.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
setup=
case "${1:-}" in
  "") ;;
  --setup) setup=1 ;;
  --help | -h) sed -n '2,11s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;;
  *) echo "try_container: unknown argument $1; see --help" >&2; exit 2 ;;
esac
fail() { echo "try_container: $*" >&2; exit 1; }
compgen -G 'out/release/lte_*_amd64.deb' >/dev/null ||
  fail "no packages in out/release: run scripts/release.sh"
[ "$(id -u)" -eq 0 ] || fail "needs root, for chroot"
for tool in buildah mmdebstrap; do
  command -v "$tool" >/dev/null || { apt-get update -qq &&
    apt-get install -y -qq --no-install-recommends "$tool" >/dev/null; } || fail "no $tool"
done

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/images" "$work/run"
export BUILDAH_ISOLATION=chroot
in_store() { buildah --storage-driver vfs --root "$work/images" --runroot "$work/run" "$@"; }
base=$(in_store from scratch)
mmdebstrap --quiet --variant=apt --include=ca-certificates --format=tar bookworm - \
  $(ls /etc/apt/sources.list /etc/apt/sources.list.d/* 2>/dev/null | grep -E '\.(list|sources)$') |
  tar -x -C "$(in_store mount "$base")" || fail "no Debian from mmdebstrap"
# The network may be one that signs by certificates of its own.
cp /etc/ssl/certs/ca-certificates.crt "$(in_store mount "$base")/etc/ssl/certs/"
in_store umount "$base" >/dev/null
in_store config --env PIP_CERT=/etc/ssl/certs/ca-certificates.crt "$base"
for name in 12 12-slim; do in_store commit -q "$base" "debian:$name" >/dev/null; done
in_store rm "$base" >/dev/null

begin=$SECONDS
in_store build -q --network host -t lte . >"$work/log" 2>&1 || { cat "$work/log"; fail "buildah build"; }
echo "try_container: lte built in $((SECONDS - begin)) s"
demo=(demo --quality draft --size 160x120 --quiet --set denoise=off --out)
build-packages/bin/lte "${demo[@]}" "$work/own.png"
box=$(in_store from lte)
in_store run "$box" -- lte "${demo[@]}" /tmp/room.png
cmp "$(in_store mount "$box")/tmp/room.png" "$work/own.png" || fail "not the build's own picture"
echo "try_container: its demo is the build's own picture"
[ -n "$setup" ] || exit 0
begin=$SECONDS
in_store build -q --network host --target setup -t lte-setup . >"$work/log" 2>&1 ||
  { cat "$work/log"; fail "buildah build --target setup"; }
box=$(in_store from lte-setup)
in_store run "$box" -- bash -c 'ls .venv/lib/python3*/site-packages/torch/lib/libtorch_cpu.so \
  .venv/xatlas/xatlas.cpp && ninja --version && clang-tidy --version' >"$work/log" ||
  fail "the stage setup lacks what the sources need"
echo "try_container: stage setup built in $((SECONDS - begin)) s"
