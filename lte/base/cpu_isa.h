// The instruction set that a user holds the program to.
#pragma once

#include <string>

namespace lte {

/// What the environment variable LTE_CPU_ISA says: baseline, avx2, avx512, avx512_bf16 or amx;
/// empty if it is not set. Kernels of lte/ops and Embree then take none beyond it; without it they
/// take the best that the processor has. What vector_clones.h compiles, computes the same bits with
/// each set and takes the best always.
/// @throws lte::Error if it says anything else
std::string wanted_cpu_isa();

}  // namespace lte
