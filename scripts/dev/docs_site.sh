#!/usr/bin/env bash
# Makes pages of the library's headers and of docs/ by Doxygen, in out/docs/html/index.html.
#
# usage: scripts/dev/docs_site.sh
#
# Needs doxygen (Debian: doxygen); its settings are docs/Doxyfile. What it warns of goes to
# out/docs/warnings.txt.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
case "${1:-}" in
  "") ;;
  --help | -h) sed -n '2,7s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;;
  *) echo "docs_site: unknown argument $1; see --help" >&2; exit 2 ;;
esac
command -v doxygen >/dev/null || { echo "docs_site: doxygen is missing (apt-get install doxygen)" >&2; exit 2; }
rm -rf out/docs
mkdir -p out/docs
doxygen docs/Doxyfile
echo "docs_site: out/docs/html/index.html, $(wc -l < out/docs/warnings.txt) warnings in out/docs/warnings.txt"
