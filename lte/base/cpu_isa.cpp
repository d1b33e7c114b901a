#include "lte/base/cpu_isa.h"

#include <cstdlib>

#include "lte/base/check.h"

namespace lte {

std::string wanted_cpu_isa() {
  const char* variable = std::getenv("LTE_CPU_ISA");
  std::string wanted = variable == nullptr ? "" : variable;
  LTE_CHECK(wanted.empty() || wanted == "baseline" || wanted == "avx2" || wanted == "avx512" ||
                wanted == "avx512_bf16" || wanted == "amx",
            "LTE_CPU_ISA must be baseline, avx2, avx512, avx512_bf16 or amx, got ", wanted);
  return wanted;
}

}  // namespace lte
