// Irradiance at a C program's points, by an integrator.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>
#include <vector>

#include "lte/c_api/arguments.h"
#include "lte/c_api/render.h"

namespace lte::c_api {
namespace {

/// Points whose irradiance is computed at once.
constexpr size_t kBlock = 1 << 16;
/// By which normals may be longer or shorter than 1.
constexpr float kUnit = 0.01f;

/// The points that the mask keeps, and their rows.
struct KeptPoints {
  std::vector<Vec3> position, normal;
  std::vector<int64_t> row;
};

Vec3 row_of(const runtime::TriplesIn& from, int64_t row) {
  Vec3 out;
  std::memcpy(&out, reinterpret_cast<const char*>(from.data) + row * from.stride, sizeof out);
  return out;
}

KeptPoints read_points(const lte_queries& from) {
  const runtime::QueriesIn points = read_queries(from, {}, /*albedo=*/false);
  KeptPoints out;
  for (int64_t row = 0; row < points.count; ++row) {
    if (points.mask != nullptr && points.mask[row * points.mask_stride] == 0) continue;
    const Vec3 position = row_of(points.position, row), normal = row_of(points.normal, row);
    const auto check = [&](bool good, const char* what, const char* fault) {
      require(good, "queries: ", what, " of row ", row, fault);
    };
    if (!points.trusted) {
      check(std::isfinite(dot(position, position)), "position", " is not finite");
      check(std::abs(length(normal) - 1) <= kUnit, "normal", " is not unit");
    }
    out.position.push_back(position);
    out.normal.push_back(normal);
    out.row.push_back(row);
  }
  return out;
}

void put(const runtime::TriplesOut& to, int64_t row, const Rgb& value) {
  std::memcpy(reinterpret_cast<char*>(to.data) + row * to.stride, &value, sizeof value);
}

}  // namespace

void irradiance(const render::Integrator& integrator, const lte_queries& points,
                render::PointSampling sampling, const IrradianceOut& out) {
  const KeptPoints kept = read_points(points);
  if (out.direct == nullptr) sampling.light_samples = 0;
  if (out.indirect == nullptr) sampling.rays = 0;
  runtime::TriplesOut direct, indirect;
  if (points.count > 0 && out.direct != nullptr)
    direct = read_output(out.direct, out.stride, points.count, "direct");
  if (points.count > 0 && out.indirect != nullptr)
    indirect = read_output(out.indirect, out.stride, points.count, "indirect");
  for (int64_t row = 0; row < points.count; ++row) {
    if (direct.data != nullptr) put(direct, row, {});
    if (indirect.data != nullptr) put(indirect, row, {});
  }
  for (size_t first = 0; first < kept.row.size(); first += kBlock) {
    const size_t count = std::min(kBlock, kept.row.size() - first);
    sampling.first_index = static_cast<int64_t>(first);
    const render::PointIrradiance light =
        integrator.irradiance({std::span(kept.position).subspan(first, count),
                               std::span(kept.normal).subspan(first, count)},
                              sampling);
    for (size_t i = 0; i < light.direct.size(); ++i)
      put(direct, kept.row[first + i], light.direct[i]);
    for (size_t i = 0; i < light.indirect.size(); ++i)
      put(indirect, kept.row[first + i], light.indirect[i]);
  }
}

}  // namespace lte::c_api
