// Products of bfloat16 in AMX's matrix registers: one instruction adds the product of 16 rows by 16
// pairs and 16 pairs by 16 columns to 16 × 16 sums in float32. Weights in pairs, as the other
// kernels read them, are what it wants of the right factor.
//
// Only kernel files for AMX include this. Its instructions are written out here, as GCC's
// intrinsics do not say that they read and write memory, nor take a register as a template's
// argument.
//
// Source: Intel, "Architecture Instruction Set Extensions Programming Reference", chapter 3.
#pragma once

#include <cstdint>

#include "lte/ops/cpu/kernels/kernels.h"
#include "lte/ops/cpu/kernels/product.h"
#include "lte/ops/cpu/kernels/vector.h"

namespace lte::ops::LTE_ISA {

/// Rows, pairs and columns of one register.
inline constexpr int64_t kAmxRows = 16;
inline constexpr int64_t kAmxRowBytes = 64;
static_assert(kBlock == kAmxRows, "a block of columns is a register wide");

template <int REGISTER>
inline void amx_load(const void* from, int64_t row_bytes) {
  asm volatile("tileloadd (%0,%1,1), %%tmm%c2" ::"r"(from), "r"(row_bytes), "i"(REGISTER)
               : "memory");
}
template <int REGISTER>
inline void amx_store(void* to, int64_t row_bytes) {
  asm volatile("tilestored %%tmm%c2, (%0,%1,1)" ::"r"(to), "r"(row_bytes), "i"(REGISTER)
               : "memory");
}
template <int REGISTER>
inline void amx_clear() {
  asm volatile("tilezero %%tmm%c0" ::"i"(REGISTER));
}
template <int SUM, int LEFT, int RIGHT>
inline void amx_add_product() {
  asm volatile("tdpbf16ps %%tmm%c2, %%tmm%c1, %%tmm%c0" ::"i"(SUM), "i"(LEFT), "i"(RIGHT));
}

/// Which registers hold what: two runs of rows by two blocks of columns.
enum AmxRegister : int {
  kUpperFirst,  ///< sums
  kUpperSecond,
  kLowerFirst,
  kLowerSecond,
  kUpper,  ///< the left factor
  kLower,
  kFirst,  ///< the right factor
  kSecond,
};

/// Gives the registers their shapes.
/// @param rows   of the left factor and the sums, 1 to kAmxRows
/// @param depth  pairs of both factors, 1 to kAmxRows
inline void shape_amx_registers(int64_t rows, int64_t depth) {
  struct alignas(64) Table {
    uint8_t palette = 1, start_row = 0, reserved[14] = {};
    uint16_t row_bytes[16] = {};
    uint8_t rows[16] = {};
  };
  Table table, now;
  const auto shape = [&](int i, int64_t of_rows, int64_t row_bytes) {
    table.rows[i] = static_cast<uint8_t>(of_rows);
    table.row_bytes[i] = static_cast<uint16_t>(row_bytes);
  };
  for (int i = kUpperFirst; i <= kLowerSecond; ++i) shape(i, rows, kAmxRowBytes);
  for (int i = kUpper; i <= kLower; ++i) {
    shape(i, rows, depth * static_cast<int64_t>(sizeof(uint32_t)));
  }
  for (int i = kFirst; i <= kSecond; ++i) shape(i, depth, kAmxRowBytes);
  // Shaping takes as long as 16 products, asking for the shapes as long as one. They are asked of
  // the processor, as other libraries in this thread may have changed them.
  asm volatile("sttilecfg %0" : "=m"(now));
  if (__builtin_memcmp(&now, &table, sizeof now) != 0) asm volatile("ldtilecfg %0" ::"m"(table));
}

/// A product whose left factor is rounded: `x` is [rows, x_stride] pairs, and K counts pairs.
struct AmxProduct {
  const uint32_t* x;
  int64_t x_stride, out_stride;
  MatrixProduct<uint32_t, uint32_t> of;  ///< its own `x` is not read
};

/// Sums of ROWS runs of rows, from row `r`, and BLOCKS blocks of columns, from block `b`, over runs
/// of `depth` pairs. Pairs are added in the same order for any ROWS and BLOCKS.
template <int ROWS, int BLOCKS>
void add_amx_products(const AmxProduct& p, int64_t depth, int64_t r, int64_t b) {
  const int64_t out_bytes = p.out_stride * static_cast<int64_t>(sizeof(float));
  const int64_t x_bytes = p.x_stride * static_cast<int64_t>(sizeof(uint32_t));
  const int64_t weight_bytes = p.of.row_stride * static_cast<int64_t>(sizeof(uint32_t));
  float* upper_out = p.of.out + r * p.out_stride + b * kBlock;
  float* lower_out = upper_out + kAmxRows * p.out_stride;
  if (p.of.add) {
    amx_load<kUpperFirst>(upper_out, out_bytes);
    if constexpr (BLOCKS > 1) amx_load<kUpperSecond>(upper_out + kBlock, out_bytes);
    if constexpr (ROWS > 1) amx_load<kLowerFirst>(lower_out, out_bytes);
    if constexpr (ROWS > 1 && BLOCKS > 1) amx_load<kLowerSecond>(lower_out + kBlock, out_bytes);
  } else if (p.of.bias != nullptr) {
    const float* bias = p.of.bias + b * kBlock;  // the same row over and over
    amx_load<kUpperFirst>(bias, 0);
    if constexpr (BLOCKS > 1) amx_load<kUpperSecond>(bias + kBlock, 0);
    if constexpr (ROWS > 1) amx_load<kLowerFirst>(bias, 0);
    if constexpr (ROWS > 1 && BLOCKS > 1) amx_load<kLowerSecond>(bias + kBlock, 0);
  } else {
    amx_clear<kUpperFirst>();
    if constexpr (BLOCKS > 1) amx_clear<kUpperSecond>();
    if constexpr (ROWS > 1) amx_clear<kLowerFirst>();
    if constexpr (ROWS > 1 && BLOCKS > 1) amx_clear<kLowerSecond>();
  }
  const uint32_t *upper = p.x + r * p.x_stride, *lower = upper + kAmxRows * p.x_stride;
  const uint32_t *first = p.of.weight + b * p.of.block_stride, *second = first + p.of.block_stride;
  for (int64_t k = 0; k < p.of.K; k += depth) {
    amx_load<kUpper>(upper + k, x_bytes);
    amx_load<kFirst>(first + k * p.of.row_stride, weight_bytes);
    if constexpr (ROWS > 1) amx_load<kLower>(lower + k, x_bytes);
    if constexpr (BLOCKS > 1) amx_load<kSecond>(second + k * p.of.row_stride, weight_bytes);
    amx_add_product<kUpperFirst, kUpper, kFirst>();
    if constexpr (BLOCKS > 1) amx_add_product<kUpperSecond, kUpper, kSecond>();
    if constexpr (ROWS > 1) amx_add_product<kLowerFirst, kLower, kFirst>();
    if constexpr (ROWS > 1 && BLOCKS > 1) amx_add_product<kLowerSecond, kLower, kSecond>();
  }
  amx_store<kUpperFirst>(upper_out, out_bytes);
  if constexpr (BLOCKS > 1) amx_store<kUpperSecond>(upper_out + kBlock, out_bytes);
  if constexpr (ROWS > 1) amx_store<kLowerFirst>(lower_out, out_bytes);
  if constexpr (ROWS > 1 && BLOCKS > 1) amx_store<kLowerSecond>(lower_out + kBlock, out_bytes);
}

template <int ROWS>
void add_amx_rows(const AmxProduct& p, int64_t depth, int64_t r) {
  int64_t b = 0;
  for (; b + 2 <= p.of.blocks; b += 2) add_amx_products<ROWS, 2>(p, depth, r, b);
  if (b < p.of.blocks) add_amx_products<ROWS, 1>(p, depth, r, b);
}

/// Pairs a register, so that `pairs` are a few equal runs of at least half a register; 0 if they
/// are not.
inline int64_t amx_depth(int64_t pairs) {
  for (int64_t runs = (pairs + kAmxRows - 1) / kAmxRows; runs * kAmxRows <= 2 * pairs; ++runs) {
    if (pairs % runs == 0) return pairs / runs;
  }
  return pairs <= kAmxRows ? pairs : 0;
}

/// DenseKernels::multiply() of pairs. A bias and what `out` holds are not added both.
inline void amx_multiply(AmxProduct p) {
  const int64_t depth = amx_depth(p.of.K);
  if (depth == 0) {  // whole registers, then the rest
    AmxProduct rest = p;
    p.of.K = p.of.K / kAmxRows * kAmxRows;
    rest.x += p.of.K;
    rest.of.weight += p.of.K * p.of.row_stride;
    rest.of.K -= p.of.K;
    rest.of.add = true;
    amx_multiply(p);
    amx_multiply(rest);
    return;
  }
  const int64_t whole = p.of.rows / kAmxRows * kAmxRows;
  if (whole > 0) {
    shape_amx_registers(kAmxRows, depth);
    int64_t r = 0;
    for (; r + 2 * kAmxRows <= whole; r += 2 * kAmxRows) add_amx_rows<2>(p, depth, r);
    if (r < whole) add_amx_rows<1>(p, depth, r);
  }
  if (whole < p.of.rows) {
    shape_amx_registers(p.of.rows - whole, depth);
    add_amx_rows<1>(p, depth, whole);
  }
}

}  // namespace lte::ops::LTE_ISA
