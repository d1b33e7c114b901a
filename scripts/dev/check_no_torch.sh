#!/usr/bin/env bash
# Fails where the tools without LibTorch would not link: what they ask of lte/runtime and lte/nn
# must be in those folders as LTE_TORCH=OFF builds them. Compiles these two alone, and takes the
# rest from a build with LibTorch.
#
# usage: scripts/dev/check_no_torch.sh [BUILD]     build by default
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
build=${1:-build}
tools=("$build"/lib/liblte_{embed,infer,render_command,probe_command,view_server}.a)
for library in "${tools[@]}"; do
  [ -e "$library" ] || { echo "check_no_torch: there is no $library" >&2; exit 2; }
done
cmake --preset no-torch -DLTE_TESTS=OFF >/dev/null
cmake --build --preset no-torch --target lte_nn lte_runtime >/dev/null
wanted=$(nm -A --undefined-only "${tools[@]}" | awk '{print $NF}' |
         grep -E '^_ZNK?3lte(7runtime|2nn)' | sort -u)
there=$(nm --defined-only build-no-torch/lib/liblte_{nn,runtime}.a "${tools[@]}" 2>/dev/null |
        awk 'NF == 3 {print $3}' | sort -u)
missing=$(comm -23 <(echo "$wanted") <(echo "$there"))
if [ -n "$missing" ]; then
  echo "check_no_torch: lte/runtime/no_network.cpp lacks:"
  c++filt <<<"$missing"
  exit 1
fi
echo "check_no_torch: $(wc -l <<<"$wanted") functions of lte/runtime and lte/nn, all there without LibTorch"
