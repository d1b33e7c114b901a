// Three floats in code that processors and GPUs share: functions of C, as device code has no
// others.
#pragma once

#include "lte/tensor/tensor.h"

namespace lte::ops {

struct Triple {
  float x = 0, y = 0, z = 0;
};
C10_HOST_DEVICE inline Triple operator+(Triple a, Triple b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
C10_HOST_DEVICE inline Triple operator-(Triple a, Triple b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
C10_HOST_DEVICE inline Triple operator*(Triple a, Triple b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}
C10_HOST_DEVICE inline Triple operator*(Triple a, float s) { return {a.x * s, a.y * s, a.z * s}; }
C10_HOST_DEVICE inline float dot(Triple a, Triple b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
C10_HOST_DEVICE inline Triple triple_at(const float* p) { return {p[0], p[1], p[2]}; }

}  // namespace lte::ops
