#!/usr/bin/env bash
# clang-tidy on the sources that are named, or that differ from a base revision; fails on findings.
#
# usage: scripts/dev/tidy.sh [--base REVISION] [--all] [--without-torch] [--most N] [--build DIR]
#                            [FILE.cpp ...]
#
#   (nothing)          what differs from main, uncommitted changes included
#   --base REVISION    what differs from REVISION
#   --all              every source of the build: about a minute a LibTorch file, so hours
#   --without-torch    no source that includes LibTorch, which takes a minute
#   --most N           N sources at most; a line says how many are left out
#   --build DIR        configured build folder with compile_commands.json (default: build)
#
# A header is looked at through the sources that include it: name one of them. Checks: .clang-tidy.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
base=main build=build all=0 torch=1 most=0
declare -a files=()
while [ $# -gt 0 ]; do
  case "$1" in
    --base) base=$2; shift 2 ;;
    --build) build=$2; shift 2 ;;
    --all) all=1; shift ;;
    --without-torch) torch=0; shift ;;
    --most) most=$2; shift 2 ;;
    --help | -h) sed -n '2,15s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;;
    -*) echo "tidy: unknown flag $1; see --help" >&2; exit 2 ;;
    *) files+=("$1"); shift ;;
  esac
done
database=$build/compile_commands.json
[ -f "$database" ] || { echo "tidy: $database is missing: cmake --preset release" >&2; exit 2; }
if [ $all = 1 ]; then
  mapfile -t files < <(git ls-files '*.cpp')
elif [ ${#files[@]} = 0 ]; then
  git rev-parse --verify --quiet "$base^{commit}" >/dev/null ||
    { echo "tidy: no revision $base; name one with --base" >&2; exit 2; }
  since=$(git merge-base "$base" HEAD)
  mapfile -t files < <({ git diff --name-only --diff-filter=d "$since" -- '*.cpp'
                         git ls-files --others --exclude-standard -- '*.cpp'; } | sort -u)
fi

# The commands as clang takes them: without the flags of GCC's precompiled headers, and without
# OpenMP, whose header clang lacks on Debian.
commands=$(mktemp -d)
trap 'rm -rf "$commands"' EXIT
filtered=$commands/compile_commands.json
mapfile -t files < <(python3 - "$database" "$filtered" "$torch" "$most" "${files[@]}" <<'PYTHON'
import json, os, re, shlex, sys
database, out, torch, most, *wanted = sys.argv[1:]
wanted = {os.path.realpath(name) for name in wanted}
kept = {}

def sources(file):
    """The file, or those that it compiles together."""
    if "/Unity/unity_" not in file:
        return [os.path.realpath(file)]
    return re.findall(r'^#include "(.+)"', open(file).read(), re.M)

for entry in json.load(open(database)):
    file = os.path.join(entry["directory"], entry["file"])
    paths = [path for path in sources(file) if path in wanted and path not in kept]
    if not paths:
        continue
    words, skip = [], False
    given = shlex.split(entry["command"])
    for i, word in enumerate(given):
        if skip:
            skip = False
        elif word == "-include" and "cmake_pch" in given[i + 1]:
            skip = True
        elif word not in ("-fpch-preprocess", "-Winvalid-pch", "-fopenmp", "-Werror"):
            words.append(word)
    words.append("-Wno-unknown-warning-option")
    for path in paths:
        own = [path if word == entry["file"] else word for word in words]
        kept[path] = {"directory": entry["directory"], "file": path, "arguments": own}
for path in sorted(wanted - kept.keys()):
    print(f"tidy: {os.path.relpath(path)} is in no target of {database}: left out", file=sys.stderr)
if torch == "0":
    without = {path: entry for path, entry in kept.items()
               if not any("site-packages/torch" in word or "libtorch" in word
                          for word in entry["arguments"])}
    if len(without) < len(kept):
        print(f"tidy: {len(kept) - len(without)} files with LibTorch: left out", file=sys.stderr)
    kept = without
chosen = sorted(kept)[:int(most) or None]
if len(chosen) < len(kept):
    print(f"tidy: {len(kept) - len(chosen)} more files: left out", file=sys.stderr)
json.dump([kept[path] for path in chosen], open(out, "w"))
print("\n".join(chosen))
PYTHON
)
if [ -z "${files[0]:-}" ]; then
  echo "tidy: nothing to look at"
  exit 0
fi
printf '%s\0' "${files[@]}" |
  xargs -0 -n 1 -P "$(nproc)" "${CLANG_TIDY:-clang-tidy}" -p "$commands" --quiet \
    --warnings-as-errors='*' 2> >(grep -v 'warnings\? generated' >&2) || {
    echo "tidy: findings above" >&2
    exit 1
  }
echo "tidy: ${#files[@]} files, no findings"
