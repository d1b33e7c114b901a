#include "lte/ops/cpu/kernels/kernels.h"

#if defined(LTE_X86) && defined(__linux__)
#include <cpuid.h>
#include <sys/syscall.h>
#include <unistd.h>
#endif

#include <string>
#include <string_view>
#include <type_traits>

#include "lte/base/cpu_isa.h"
#include "lte/ops/bf16.h"

#define LTE_DECLARE_KERNELS(isa)                 \
  namespace lte::ops::isa {                      \
  extern const PointKernels kPointKernels;       \
  extern const CurveKernels kCurveKernels;       \
  extern const DenseKernels kDenseKernels;       \
  extern const GradientKernels kGradientKernels; \
  extern const Bf16Kernels kBf16Kernels;         \
  extern const PriorKernels kPriorKernels;       \
  extern const SurfelKernels kSurfelKernels;     \
  extern const SumKernels<float> kFloatSums;     \
  extern const SumKernels<double> kDoubleSums;   \
  }

LTE_DECLARE_KERNELS(baseline)
#if defined(LTE_X86)
LTE_DECLARE_KERNELS(avx2)
LTE_DECLARE_KERNELS(avx512)
namespace lte::ops::avx512_bf16 {
extern const Bf16Kernels kBf16Kernels;
}
namespace lte::ops::amx {
extern const Bf16Kernels kBf16Kernels;
}
#endif

namespace lte::ops {
namespace {

struct Isa {
  const char* name;
  const PointKernels* points;
  const CurveKernels* curves;
  const DenseKernels* dense;
  const GradientKernels* gradients;
  const Bf16Kernels* bf16;
  const PriorKernels* prior;
  const SurfelKernels* surfels;
  const SumKernels<float>* float_sums;
  const SumKernels<double>* double_sums;
};

#if defined(LTE_X86)
/// Whether the processor has AMX and the system lets this process use it, which Linux does on
/// request. Matrix registers are 8 KiB of a thread's state that it saves from then on.
bool may_use_amx() {
#if defined(__linux__)
  // Bits of CPUID's leaf 7, for which Clang 14 has no names.
  constexpr unsigned kBf16 = 1U << 22, kTiles = 1U << 24;
  constexpr int kRequestPermission = 0x1023, kTileData = 18;  // arch/x86/include/uapi/asm/prctl.h
  unsigned eax = 0, ebx = 0, ecx = 0, edx = 0;
  return __get_cpuid_count(7, 0, &eax, &ebx, &ecx, &edx) != 0 && (edx & kBf16) != 0 &&
         (edx & kTiles) != 0 && syscall(SYS_arch_prctl, kRequestPermission, kTileData) == 0;
#else
  return false;
#endif
}

struct Bf16Choice {
  const char* name;
  const Bf16Kernels* kernels;
};

/// Of a processor with AVX-512.
Bf16Choice choose_bf16(std::string_view wanted) {
  if (wanted == "avx512" || !__builtin_cpu_supports("avx512bf16"))
    return {"avx512", &avx512::kBf16Kernels};
  if (wanted == "avx512_bf16" || !may_use_amx()) return {"avx512_bf16", &avx512_bf16::kBf16Kernels};
  return {"amx", &amx::kBf16Kernels};
}
#endif

Isa choose() {
  const std::string wanted = wanted_cpu_isa();
#if defined(LTE_X86)
  const bool has_avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  const bool has_avx512 = has_avx2 && __builtin_cpu_supports("avx512f") &&
                          __builtin_cpu_supports("avx512dq") &&
                          __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw");
  if (has_avx512 && wanted != "avx2" && wanted != "baseline") {
    const Bf16Choice bf16 = choose_bf16(wanted);
    return {bf16.name,
            &avx512::kPointKernels,
            &avx512::kCurveKernels,
            &avx512::kDenseKernels,
            &avx512::kGradientKernels,
            bf16.kernels,
            &avx512::kPriorKernels,
            &avx512::kSurfelKernels,
            &avx512::kFloatSums,
            &avx512::kDoubleSums};
  }
  if (has_avx2 && wanted != "baseline") {
    return {"avx2",
            &avx2::kPointKernels,
            &avx2::kCurveKernels,
            &avx2::kDenseKernels,
            &avx2::kGradientKernels,
            &avx2::kBf16Kernels,
            &avx2::kPriorKernels,
            &avx2::kSurfelKernels,
            &avx2::kFloatSums,
            &avx2::kDoubleSums};
  }
#endif
  return {"baseline",
          &baseline::kPointKernels,
          &baseline::kCurveKernels,
          &baseline::kDenseKernels,
          &baseline::kGradientKernels,
          &baseline::kBf16Kernels,
          &baseline::kPriorKernels,
          &baseline::kSurfelKernels,
          &baseline::kFloatSums,
          &baseline::kDoubleSums};
}

const Isa& isa() {
  static const Isa chosen = choose();
  return chosen;
}

}  // namespace

const PointKernels& point_kernels() { return *isa().points; }
const CurveKernels& curve_kernels() { return *isa().curves; }
const DenseKernels& dense_kernels() { return *isa().dense; }
const GradientKernels& gradient_kernels() { return *isa().gradients; }
const Bf16Kernels& bf16_kernels() { return *isa().bf16; }
const PriorKernels& prior_kernels() { return *isa().prior; }
const SurfelKernels& surfel_kernels() { return *isa().surfels; }
bool has_bf16_products() {
  const std::string_view isa = cpu_isa();
  return isa == "avx512_bf16" || isa == "amx";
}
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
