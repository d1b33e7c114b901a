// glibc 2.35 gave hypotf a version of its own, which would keep the wheel from older systems. The
// linker puts this in its place (--wrap); it returns the same bits.
#include <cmath>

extern "C" float __wrap_hypotf(float x, float y) {  // NOLINT(bugprone-reserved-identifier)
  if (std::isinf(x) || std::isinf(y)) return INFINITY;
  return static_cast<float>(std::sqrt(double{x} * x + double{y} * y));
}
