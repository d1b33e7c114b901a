#include "lte/ops/cpu/kernels.h"

#include <cstdlib>
#include <string>
#include <type_traits>

#include <c10/util/Exception.h>

#define LTE_DECLARE_KERNELS(isa)               \
  namespace lte::ops::isa {                    \
  extern const PointKernels kPointKernels;     \
  extern const DenseKernels kDenseKernels;     \
  extern const SumKernels<float> kFloatSums;   \
  extern const SumKernels<double> kDoubleSums; \
  }

LTE_DECLARE_KERNELS(baseline)
#if defined(LTE_X86)
LTE_DECLARE_KERNELS(avx2)
LTE_DECLARE_KERNELS(avx512)
#endif

namespace lte::ops {
namespace {

struct Isa {
  const char* name;
  const PointKernels* points;
  const DenseKernels* dense;
  const SumKernels<float>* float_sums;
  const SumKernels<double>* double_sums;
};

Isa choose() {
  const char* variable = std::getenv("LTE_CPU_ISA");
  const std::string wanted = variable == nullptr ? "" : variable;
  TORCH_CHECK(wanted.empty() || wanted == "baseline" || wanted == "avx2" || wanted == "avx512",
              "LTE_CPU_ISA must be baseline, avx2 or avx512, got ", wanted);
#if defined(LTE_X86)
  const bool has_avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  const bool has_avx512 = has_avx2 && __builtin_cpu_supports("avx512f") &&
                          __builtin_cpu_supports("avx512dq") &&
                          __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw");
  if (has_avx512 && (wanted.empty() || wanted == "avx512")) {
    return {"avx512", &avx512::kPointKernels, &avx512::kDenseKernels, &avx512::kFloatSums,
            &avx512::kDoubleSums};
  }
  if (has_avx2 && wanted != "baseline") {
    return {"avx2", &avx2::kPointKernels, &avx2::kDenseKernels, &avx2::kFloatSums,
            &avx2::kDoubleSums};
  }
#endif
  return {"baseline", &baseline::kPointKernels, &baseline::kDenseKernels, &baseline::kFloatSums,
          &baseline::kDoubleSums};
}

const Isa& isa() {
  static const Isa chosen = choose();
  return chosen;
}

}  // namespace

const PointKernels& point_kernels() { return *isa().points; }
const DenseKernels& dense_kernels() { return *isa().dense; }
const char* cpu_isa() { return isa().name; }
template <typename T>
const SumKernels<T>& sum_kernels() {
  if constexpr (std::is_same_v<T, double>) {
    return *isa().double_sums;
  } else {
    return *isa().float_sums;
  }
}
template const SumKernels<float>& sum_kernels<float>();
template const SumKernels<double>& sum_kernels<double>();

}  // namespace lte::ops
