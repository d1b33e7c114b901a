#include "infer/session/traced_records.h"

#include <algorithm>

#include "lte/base/check.h"
#include "lte/base/random.h"
#include "lte/pathtrace/irradiance.h"

namespace lte::infer {
namespace {

// Points between two checks: some 10 ms of two cores.
constexpr size_t kBlock = 2048;
// As those of render::make_cache().
constexpr uint64_t kPlaces = 21, kLight = 22;

void add_groups(const std::vector<Rgb>& values, size_t records, std::span<const int> groups,
                std::span<const Rgb> gains, std::vector<Rgb>* sum) {
  for (size_t g = 0; g < groups.size(); ++g) {
    const Rgb* row = values.data() + records * static_cast<size_t>(groups[g]);
    for (size_t i = 0; i < records; ++i) (*sum)[i] += row[i] * gains[g];
  }
}

}  // namespace

gi::RecordLight TracedRecords::light_of(std::span<const int> of_groups,
                                        std::span<const Rgb> gains) const {
  LTE_CHECK(of_groups.size() == gains.size(), "records of light: ", of_groups.size(),
            " groups but ", gains.size(), " gains");
  for (const int group : of_groups)
    LTE_CHECK(group >= 0 && group < groups, "records of light: there is no group ", group);
  gi::RecordLight out;
  out.direct.resize(places.position.size());
  out.indirect.resize(out.direct.size());
  add_groups(direct, out.direct.size(), of_groups, gains, &out.direct);
  add_groups(indirect, out.direct.size(), of_groups, gains, &out.indirect);
  if (last.empty()) return out;
  out.last.resize(out.direct.size());
  add_groups(last, out.direct.size(), of_groups, gains, &out.last);
  return out;
}

TracedRecords trace_records(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                            const render::CacheSettings& settings, render::Method method,
                            const std::function<void()>& check) {
  LTE_CHECK(settings.paths >= 1, "an irradiance cache needs a path a record, got ", settings.paths);
  const bool raw = method != render::Method::Network;
  const uint64_t places = hash_combine(settings.seed, kPlaces);
  TracedRecords out;
  out.groups = lights.groups();
  // A gather adds a bounce to the table's light, so light of depth 1 is all that none has.
  if (raw && (lights.empty() || settings.max_depth < 2)) return out;
  out.places = gi::sample_records(bvh, settings.records, places);
  out.geometry = std::make_shared<const gi::CacheGeometry>(bvh, out.places);
  const auto count = static_cast<size_t>(out.places.size());
  const auto groups = static_cast<size_t>(out.groups);
  out.direct.resize(groups * count);
  out.indirect.resize(groups * count);
  if (lights.empty()) return out;
  pathtrace::IrradianceOptions options;
  options.rays = std::max(1, settings.paths / gi::kRecordPoints);
  options.max_depth = raw ? settings.max_depth - 1 : 1;
  options.seed = raw ? hash_combine(settings.seed, kLight) : places;
  options.variance = false;
  options.direct_only = options.max_depth == 1;
  options.last_bounce = raw;
  if (raw) out.last.resize(out.direct.size());
  const std::vector<Vec3>&start = out.places.start, &normal = out.places.start_normal;
  std::vector<Rgb> direct(groups * start.size()), indirect(direct.size());
  std::vector<Rgb> last(raw ? direct.size() : 0);
  for (size_t first = 0; first < start.size(); first += kBlock) {
    if (check) check();
    const size_t size = std::min(kBlock, start.size() - first);
    const pathtrace::Irradiance light = pathtrace::estimate_irradiance(
        bvh, lights, std::span(start).subspan(first, size), std::span(normal).subspan(first, size),
        options, static_cast<int64_t>(first));
    const auto take = [&](const std::vector<Rgb>& from, std::vector<Rgb>* to) {
      for (size_t g = 0; g < from.size() / size; ++g)
        std::copy_n(from.begin() + static_cast<ptrdiff_t>(g * size), size,
                    to->begin() + static_cast<ptrdiff_t>(g * start.size() + first));
    };
    take(light.direct, &direct);
    take(light.indirect, &indirect);
    take(light.last, &last);
  }
  for (size_t g = 0; g < groups; ++g) {
    const auto put = [&](const std::vector<Rgb>& values, std::vector<Rgb>* to) {
      const std::span of_group = std::span(values).subspan(g * start.size(), start.size());
      std::ranges::copy(gi::record_means(out.places, of_group),
                        to->begin() + static_cast<ptrdiff_t>(g * count));
    };
    put(direct, &out.direct);
    put(indirect, &out.indirect);
    if (raw) put(last, &out.last);
  }
  return out;
}

}  // namespace lte::infer
