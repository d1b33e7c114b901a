// Internal: functions compiled for several instruction sets, of which the program takes the widest
// that the machine has when it starts.
//
// The files that use it are compiled without contraction of a * b + c (CMakeLists.txt), so that
// every version computes the same bits.
#pragma once

#if defined(__x86_64__) && defined(__gnu_linux__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__clang__)
#define LTE_VECTOR_CLONES \
  __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define LTE_VECTOR_CLONES
#endif
