#include "lte/pathtrace/incident/hemisphere_bins.h"

#include <algorithm>
#include <cmath>

#include "lte/base/check.h"

namespace lte::pathtrace {

Vec3 bin_direction(const Vec2& place) {
  const float a = 2 * place.x - 1, b = 2 * place.y - 1;
  if (a == 0 && b == 0) return {0, 0, 1};
  const bool wide = std::fabs(a) > std::fabs(b);
  const float radius = wide ? a : b;
  const float angle = wide ? kPi / 4 * (b / a) : kPi / 2 - kPi / 4 * (a / b);
  return {radius * std::cos(angle), radius * std::sin(angle),
          std::sqrt(std::max(0.0f, 1 - radius * radius))};
}

Vec2 bin_place(const Vec3& direction) {
  const float radius =
      std::min(1.0f, std::sqrt(direction.x * direction.x + direction.y * direction.y));
  if (!(radius > 0)) return {0.5f, 0.5f};
  float a = 0, b = 0;
  if (std::fabs(direction.x) > std::fabs(direction.y)) {
    a = std::copysign(radius, direction.x);
    b = a * std::atan(direction.y / direction.x) * (4 / kPi);
  } else {
    b = std::copysign(radius, direction.y);
    a = b * std::atan(direction.x / direction.y) * (4 / kPi);
  }
  return {std::clamp((a + 1) / 2, 0.0f, 1.0f), std::clamp((b + 1) / 2, 0.0f, 1.0f)};
}

Vec3 bin_centre(int bins, int row, int column) {
  const auto middle = [bins](int cell) {
    return (static_cast<float>(cell) + 0.5f) / static_cast<float>(bins);
  };
  return bin_direction({middle(column), middle(row)});
}

std::vector<Vec3> bin_centres(int bins, const Vec3& normal) {
  const BinFrame frame(normal);
  std::vector<Vec3> out;
  for (int row = 0; row < bins; ++row) {
    for (int column = 0; column < bins; ++column)
      out.push_back(frame.to_world(bin_centre(bins, row, column)));
  }
  return out;
}

double bin_solid_angle(int bins, int row, int column) {
  LTE_CHECK(bins >= 2 && bins % 2 == 0, "bins must be even and at least 2, got ", bins);
  // By symmetry in the quarter of positive coordinates, and there in the half where x >= y: radius
  // x, azimuth π/4 y/x, so dω = sinθ dθ dφ = π/4 / √(1 − x²) dx dy.
  const auto from_centre = [bins](int cell) {
    return cell >= bins / 2 ? cell - bins / 2 : bins / 2 - 1 - cell;
  };
  const int far = std::max(from_centre(row), from_centre(column));
  const int near = std::min(from_centre(row), from_centre(column));
  const double width = 2.0 / bins, low = far * width, high = std::min(1.0, low + width);
  const double angle = std::asin(high) - std::asin(low);
  if (far != near) return M_PI / 4 * width * angle;
  // Twice ∫ (x − low) / √(1 − x²) dx: the diagonal cuts the cell in two.
  return M_PI / 2 * (std::sqrt(1 - low * low) - std::sqrt(1 - high * high) - low * angle);
}

}  // namespace lte::pathtrace
