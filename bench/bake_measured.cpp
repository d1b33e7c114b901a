#include "bench/bake_measured.h"

#include <algorithm>

#include "lte/bake/seams.h"

namespace lte::bench {
namespace {

/// Of the mean of all texels: what is darker counts as dark.
constexpr double kDarkShare = 0.01;

}  // namespace

BakeRow measure(const MeasuredScene& m, const std::string& name, const Seconds& seconds,
                const std::function<Rgb(size_t k)>& answer) {
  double mean = 0;
  const size_t count = m.which.size();
  for (size_t k = 0; k < count; ++k)
    mean += double{luminance(m.true_light(k))} / static_cast<double>(count);
  BakeRow row{name, seconds + m.layout_seconds};
  std::vector<double> errors;
  double sum = 0, light = 0;
  int64_t dark = 0;
  for (size_t k = 0; k < count; ++k) {
    const double want = double{luminance(m.true_light(k))}, got = double{luminance(answer(k))};
    if (want < kDarkShare * mean) {
      row.leak += got / mean;
      ++dark;
      continue;
    }
    // Noise of the two is independent, so that their product is the answer's own error alone.
    row.rel_mse += (got - double{luminance(m.truth[0][k])}) *
                   (got - double{luminance(m.truth[1][k])}) / (want * want + 0.01 * mean * mean);
    errors.push_back(std::abs(got - want) / want);
    sum += got;
    light += want;
  }
  row.leak /= static_cast<double>(std::max<int64_t>(1, dark));
  if (errors.empty()) return row;
  row.rel_mse /= static_cast<double>(errors.size());
  row.bias = sum / light - 1;
  std::sort(errors.begin(), errors.end());
  row.median = errors[errors.size() / 2];
  row.p95 = errors[errors.size() * 95 / 100];
  return row;
}

BakeRow measure_picture(const MeasuredScene& m, const std::string& name, const Seconds& seconds,
                        const std::vector<float>& light, const std::vector<uint8_t>& mask) {
  BakeRow row = measure(m, name, seconds, [&](size_t k) {
    const size_t pixel = m.layout.texels.pixel[m.which[k]];
    // What fills a texel behind a wall is its neighbours' light and no answer of its own.
    if (mask[pixel] == static_cast<uint8_t>(bake::Texel::Filled)) return m.true_light(k);
    return Rgb{light[3 * pixel], light[3 * pixel + 1], light[3 * pixel + 2]};
  });
  row.seam = bake::seam_difference(bake::find_seams(m.layout.atlas, mask), light, 0.99);
  return row;
}

}  // namespace lte::bench
