#include "infer/renderer/sparse_light.h"

#include <optional>
#include <utility>

#include "lte/base/parallel.h"
#include "lte/gi/upsample.h"

namespace lte::infer {
namespace {

/// Pixels around its own in which a query of anti-aliasing looks for its surface. Those next to it
/// hold none, or it would have shared their query.
constexpr int kExtraRadius = 4;
/// Pixels that a thread takes at a time.
constexpr int64_t kPixels = 1 << 14;

gi::Query query_at(const QuerySet& queries, size_t index) {
  return {queries.position[index], queries.normal[index], queries.albedo[index]};
}

/// The queries of `asked` by their indices.
std::vector<Rgb> ask(const QuerySet& queries, std::span<const size_t> asked,
                     const gi::Answerer& answer) {
  std::vector<gi::Query> list;
  list.reserve(asked.size());
  for (const size_t index : asked) list.push_back(query_at(queries, index));
  return list.empty() ? std::vector<Rgb>() : answer(list);
}

/// Pixels of the band that ask something, as what the quadtree takes.
struct Centres {
  explicit Centres(const PictureBand& band) {
    const auto query = band.query_of_pixel();
    mask.resize(query.size());
    albedo.resize(query.size());
    for (size_t i = 0; i < query.size(); ++i) {
      if (query[i] == scene::kNone) continue;
      mask[i] = 1;
      albedo[i] = band.queries().albedo[static_cast<size_t>(query[i])];
    }
  }
  std::vector<uint8_t> mask;
  std::vector<Rgb> albedo;
};

}  // namespace

std::vector<size_t> interpolate_extras(const PictureBand& band, std::vector<Rgb>* values) {
  const auto query = band.query_of_pixel();
  if (band.queries().size() == band.centre_queries()) return {};
  std::vector<Rgb> of_pixel(query.size());
  parallel_for(static_cast<int64_t>(query.size()), kPixels, [&](int64_t begin, int64_t end) {
    for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i) {
      if (query[i] != scene::kNone) of_pixel[i] = (*values)[static_cast<size_t>(query[i])];
    }
  });
  return interpolate_extras(band, of_pixel, *values);
}

std::vector<size_t> interpolate_extras(const PictureBand& band, std::span<const Rgb> of_pixel,
                                       std::span<Rgb> values) {
  const std::vector<PictureBand::ExtraQuery> extras = band.extra_queries();
  const QuerySet& queries = band.queries();
  const auto first = static_cast<size_t>(band.centre_queries());
  const auto query = band.query_of_pixel();
  if (extras.empty()) return {};
  std::vector<uint8_t> mask(query.size()), open(extras.size());
  parallel_for(static_cast<int64_t>(query.size()), kPixels, [&](int64_t begin, int64_t end) {
    for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i)
      mask[i] = query[i] != scene::kNone ? 1 : 0;
  });
  const gi::PixelSurfaces surfaces = band.surfaces(mask);
  parallel_for(static_cast<int64_t>(extras.size()), 256, [&](int64_t begin, int64_t end) {
    for (auto k = static_cast<size_t>(begin); k < static_cast<size_t>(end); ++k) {
      const size_t at = first + k;
      const std::optional<Rgb> near = gi::nearest_known(
          surfaces, extras[k].pixel % surfaces.width, extras[k].pixel / surfaces.width,
          {queries.position[at], queries.normal[at], extras[k].depth}, mask, of_pixel,
          kExtraRadius);
      open[k] = near ? 0 : 1;
      if (near) values[at] = *near;
    }
  });
  std::vector<size_t> asked;
  for (size_t k = 0; k < open.size(); ++k) {
    if (open[k]) asked.push_back(first + k);
  }
  return asked;
}

SparseLight light_sparsely(const PictureBand& band, const gi::SparseOptions& options,
                           const gi::Answerer& answer) {
  const Centres centres(band);
  const gi::PixelSurfaces surfaces = band.surfaces(centres.mask);
  const gi::SparseAnswers answers =
      gi::answer_sparsely(surfaces, centres.albedo, {}, options, answer);
  SparseLight out;
  out.irradiance.resize(static_cast<size_t>(band.queries().size()));
  out.answers = answers.answers;
  const auto query = band.query_of_pixel();
  for (size_t i = 0; i < query.size(); ++i) {
    if (query[i] != scene::kNone)
      out.irradiance[static_cast<size_t>(query[i])] = answers.irradiance[i];
  }
  const std::vector<size_t> asked = interpolate_extras(band, &out.irradiance);
  const std::vector<Rgb> more = ask(band.queries(), asked, answer);
  for (size_t k = 0; k < asked.size(); ++k) out.irradiance[asked[k]] = more[k];
  out.answers += static_cast<int64_t>(asked.size());
  return out;
}

SparseLight light_everywhere(const PictureBand& band, const gi::Answerer& answer) {
  const auto part = [&](int64_t first, int64_t last) {
    std::vector<size_t> asked(static_cast<size_t>(last - first));
    for (size_t i = 0; i < asked.size(); ++i) asked[i] = static_cast<size_t>(first) + i;
    return ask(band.queries(), asked, answer);
  };
  SparseLight out;
  out.irradiance = part(0, band.centre_queries());
  const std::vector<Rgb> more = part(band.centre_queries(), band.queries().size());
  out.irradiance.insert(out.irradiance.end(), more.begin(), more.end());
  out.answers = static_cast<int64_t>(out.irradiance.size());
  return out;
}

}  // namespace lte::infer
