// Which discs of a cell a ray meets, the discs in the lanes: PlainCells of surfel_walk.h without
// its branches.
#include "lte/ops/cpu/kernels/kernels.h"
#include "lte/ops/cpu/kernels/vector.h"

#if defined(__AVX2__)
#include <immintrin.h>
#endif

namespace lte::ops::LTE_ISA {
namespace {

using Float = Vector<float>;
using Int = Vector<int32_t>;
constexpr int kWidth = kLanes<float>;

/// A bit for each lane that is all ones.
uint64_t bits_of(const Int& lanes) {
#if defined(__AVX512F__)
  return _mm512_movepi32_mask((__m512i)lanes);
#elif defined(__AVX2__)
  return static_cast<uint64_t>(_mm256_movemask_ps((__m256)lanes));
#else
  uint64_t bits = 0;
  for (int lane = 0; lane < kWidth; ++lane) bits |= (lanes[lane] & uint64_t{1}) << lane;
  return bits;
#endif
}

Float dot(const Float (&a)[3], const Float (&b)[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

uint64_t test(SurfelProbe probe, SurfelTests* out) {
  const Float direction[3] = {splat(probe.direction[0]), splat(probe.direction[1]),
                              splat(probe.direction[2])};
  const Float zero{}, near = splat(probe.near), far = splat(probe.far), limit = splat(probe.limit);
  uint64_t found = 0;
  for (int64_t i = 0; i < probe.count; i += kWidth) {
    Float offset[3], normal[3], away[3];
    for (int axis = 0; axis < 3; ++axis) {
      offset[axis] = load(probe.geometry + axis * probe.stride + i) - splat(probe.origin[axis]);
      normal[axis] = load(probe.geometry + (3 + axis) * probe.stride + i);
    }
    const Float signed_radius = load(probe.geometry + 6 * probe.stride + i);
    const Float radius = signed_radius < zero ? -signed_radius : signed_radius;
    const Float toward = dot(direction, normal), distance = dot(offset, normal) / toward;
    for (int axis = 0; axis < 3; ++axis) away[axis] = direction[axis] * distance - offset[axis];
    const Float square = dot(away, away);
    const Int met = (distance > radius * splat(kSurfelOwn)) & (distance >= near) &
                    (distance < far) & (distance <= limit) & (square < radius * radius) &
                    ((toward <= zero) | (signed_radius >= zero));
    const uint64_t bits = bits_of(met);
    if (bits == 0) continue;
    store(out->distance + i, distance);
    store(out->square + i, square);
    store(out->toward + i, toward);
    found |= bits << i;
  }
  // Lanes past the last disc are another cell's.
  return probe.count == 64 ? found : found & ((uint64_t{1} << probe.count) - 1);
}

}  // namespace

extern const SurfelKernels kSurfelKernels;
const SurfelKernels kSurfelKernels{test};

}  // namespace lte::ops::LTE_ISA
