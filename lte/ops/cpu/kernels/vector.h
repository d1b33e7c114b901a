// Vectors of the instruction set that a kernel file is being compiled for, as compiler extensions
// of GCC and Clang.
//
// Only kernel files include this. They use no inline function of the standard library: the linker
// could keep the copy that was compiled for AVX-512 and hand it to everybody.
#pragma once

#include <cstdint>

namespace lte::ops::LTE_ISA {

#if defined(__AVX512F__)
inline constexpr int kVectorBytes = 64;
#elif defined(__AVX2__)
inline constexpr int kVectorBytes = 32;
#else
inline constexpr int kVectorBytes = 16;
#endif

template <typename T>
struct VectorOf {
  typedef T type __attribute__((vector_size(kVectorBytes)));
};
template <typename T>
using Vector = typename VectorOf<T>::type;
template <typename T>
inline constexpr int kLanes = kVectorBytes / static_cast<int>(sizeof(T));

template <typename T>
static inline Vector<T> load(const T* p) {
  Vector<T> v;
  __builtin_memcpy(&v, p, sizeof v);
  return v;
}
template <typename T>
static inline void store(T* p, const Vector<T>& v) {
  __builtin_memcpy(p, &v, sizeof v);
}
template <typename T>
static inline Vector<T> splat(T s) {
  return s - Vector<T>{};
}

}  // namespace lte::ops::LTE_ISA
