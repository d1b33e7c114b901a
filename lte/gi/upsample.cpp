#include "lte/gi/upsample.h"

#include <algorithm>
#include <bit>

#include "lte/base/check.h"
#include "lte/base/parallel.h"

namespace lte::gi {
namespace {

constexpr int64_t kRows = 8, kPixels = 1 << 14;  ///< that a thread takes at a time

/// The weighted mean of the entries of a stencil that `use` names.
Rgb mean_of(const Stencil& stencil, std::span<const float> weight, unsigned use,
            std::span<const Rgb> values) {
  Rgb sum;
  float total = 0;
  for (int i = 0; i < stencil.count; ++i) {
    const auto k = static_cast<size_t>(i);
    if (!(use >> i & 1)) continue;
    sum += values[stencil.pixel[k]] * weight[k];
    total += weight[k];
  }
  return sum / total;
}

/// Fills what is open after all grids, from what was known before.
std::vector<int32_t> fill_from_nearest(const PixelSurfaces& surfaces, int radius,
                                       std::span<uint8_t> known, std::span<Rgb> values) {
  std::vector<int32_t> open, holes;
  const auto size = static_cast<int64_t>(surfaces.size());
  std::vector<std::vector<int32_t>> parts(static_cast<size_t>((size + kPixels - 1) / kPixels));
  parallel_for(size, kPixels, [&](int64_t begin, int64_t end) {
    for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i) {
      if (surfaces.mask[i] && !known[i])
        parts[static_cast<size_t>(begin / kPixels)].push_back(static_cast<int32_t>(i));
    }
  });
  for (const std::vector<int32_t>& part : parts) open.insert(open.end(), part.begin(), part.end());
  std::vector<std::optional<Rgb>> found(open.size());
  parallel_for(static_cast<int64_t>(open.size()), 256, [&](int64_t begin, int64_t end) {
    for (auto k = static_cast<size_t>(begin); k < static_cast<size_t>(end); ++k) {
      const int x = open[k] % surfaces.width, y = open[k] / surfaces.width;
      found[k] = nearest_known(surfaces, x, y, point_of(surfaces, static_cast<size_t>(open[k])),
                               known, values, radius);
    }
  });
  for (size_t k = 0; k < open.size(); ++k) {
    if (!found[k]) {
      holes.push_back(open[k]);
      continue;
    }
    values[static_cast<size_t>(open[k])] = *found[k];
    known[static_cast<size_t>(open[k])] = 1;
  }
  return holes;
}

}  // namespace

Stencil stencil_at(const PixelSurfaces& surfaces, const GridAxis& columns, const GridAxis& rows,
                   int column, int row) {
  const int x = columns.at(column), x0 = columns.before(column), x1 = columns.after(column);
  const int y = rows.at(row), y0 = rows.before(row), y1 = rows.after(row);
  const auto share = [](int first, int value, int last) {
    return last > first ? static_cast<float>(value - first) / static_cast<float>(last - first) : 0;
  };
  const float u = share(x0, x, x1), v = share(y0, y, y1);
  Stencil out;
  if (x0 == x1) {
    out.pixel = {surfaces.at(x, y0), surfaces.at(x, y1)};
    out.weight = {1 - v, v};
    out.count = 2;
  } else if (y0 == y1) {
    out.pixel = {surfaces.at(x0, y), surfaces.at(x1, y)};
    out.weight = {1 - u, u};
    out.count = 2;
  } else {
    // The first and the last are the ends of a diagonal, as are the two between.
    out.pixel = {surfaces.at(x0, y0), surfaces.at(x1, y0), surfaces.at(x0, y1),
                 surfaces.at(x1, y1)};
    out.weight = {(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v};
    out.count = 4;
  }
  return out;
}

Prediction predict(const PixelSurfaces& surfaces, size_t pixel, const Stencil& stencil,
                   std::span<const uint8_t> known, std::span<const Rgb> values) {
  const SurfacePoint point = point_of(surfaces, pixel);
  std::array<float, 4> weight{};
  unsigned use = 0;
  for (int i = 0; i < stencil.count; ++i) {
    const auto k = static_cast<size_t>(i);
    const size_t source = stencil.pixel[k];
    if (!known[source]) continue;
    // Over a plane 1/depth and irradiance/depth are linear in the picture.
    weight[k] = similarity(surfaces, point, source) * stencil.weight[k] / surfaces.depth[source];
    if (weight[k] > 0) use |= 1u << i;
  }
  Prediction out;
  if (use == 0) return out;
  out.any = true;
  const unsigned all = stencil.count == 2 ? 3u : 15u;
  if (use == all) {
    out.complete = true;
  } else if (stencil.count == 4 && ((use & 9u) == 9u || (use & 6u) == 6u)) {
    out.complete = true;  // a diagonal passes through the middle, its third corner would pull aside
    use = (use & 9u) == 9u ? 9u : 6u;
  }
  out.value = mean_of(stencil, weight, use, values);
  return out;
}

std::optional<Rgb> nearest_known(const PixelSurfaces& surfaces, int x, int y,
                                 const SurfacePoint& point, std::span<const uint8_t> known,
                                 std::span<const Rgb> values, int radius) {
  Rgb sum;
  float total = 0;
  const auto add = [&](int px, int py) {
    if (px < 0 || px >= surfaces.width || py < 0 || py >= surfaces.height) return;
    const size_t source = surfaces.at(px, py);
    if (!known[source]) return;
    const float weight = similarity(surfaces, point, source);
    sum += values[source] * weight;
    total += weight;
  };
  add(x, y);
  for (int ring = 1; ring <= radius && !(total > 0); ++ring) {
    for (int d = -ring; d <= ring; ++d) {
      add(x + d, y - ring);
      add(x + d, y + ring);
    }
    for (int d = -ring + 1; d < ring; ++d) {
      add(x - ring, y + d);
      add(x + ring, y + d);
    }
  }
  if (!(total > 0)) return std::nullopt;
  return sum / total;
}

std::vector<int32_t> upsample(const PixelSurfaces& surfaces, int step, std::span<uint8_t> known,
                              std::span<Rgb> values) {
  LTE_CHECK(step > 0 && std::has_single_bit(static_cast<unsigned>(step)),
            "upsampling: expected a step that is a power of two, got ", step);
  LTE_CHECK(known.size() == surfaces.size() && values.size() == surfaces.size(),
            "upsampling: expected values of ", surfaces.size(), " pixels, got ", values.size(),
            " and ", known.size());
  for (int grid = step / 2; grid >= 1; grid /= 2) {
    const GridAxis columns(grid, surfaces.width), rows(grid, surfaces.height);
    parallel_for(rows.count(), kRows, [&](int64_t begin, int64_t end) {
      for (int row = static_cast<int>(begin); row < end; ++row) {
        for (int column = 0; column < columns.count(); ++column) {
          if (!rows.is_new(row) && !columns.is_new(column)) continue;
          const size_t pixel = surfaces.at(columns.at(column), rows.at(row));
          if (!surfaces.mask[pixel] || known[pixel]) continue;
          const Prediction found = predict(
              surfaces, pixel, stencil_at(surfaces, columns, rows, column, row), known, values);
          if (!found.any) continue;
          values[pixel] = found.value;
          known[pixel] = 1;
        }
      }
    });
  }
  return fill_from_nearest(surfaces, step, known, values);
}

}  // namespace lte::gi
