#include "infer/light/traced_records.h"

#include <algorithm>

#include "lte/base/check.h"
#include "lte/base/random.h"
#include "lte/pathtrace/irradiance.h"

namespace lte::infer {
namespace {

// Entries between two checks: some 10 ms of two cores.
constexpr int64_t kBlock = 512;
// As those of make_light_table().
constexpr uint64_t kPlaces = 21, kLight = 22;

void add_groups(const std::vector<Rgb>& values, size_t entries, std::span<const int> groups,
                std::span<const Rgb> gains, std::vector<Rgb>* sum) {
  for (size_t g = 0; g < groups.size(); ++g) {
    const Rgb* row = values.data() + entries * static_cast<size_t>(groups[g]);
    for (size_t i = 0; i < entries; ++i) (*sum)[i] += row[i] * gains[g];
  }
}

/// [groups, entries] values of the entries to keep.
std::vector<Rgb> kept(const std::vector<Rgb>& values, std::span<const uint8_t> keep) {
  std::vector<Rgb> out;
  for (size_t i = 0; i < values.size(); ++i) {
    if (keep[i % keep.size()]) out.push_back(values[i]);
  }
  return out;
}

void drop_dark(TracedRecords* records) {
  std::vector<uint8_t> lit(records->entries.position.size());
  for (const std::vector<Rgb>* values : {&records->direct, &records->indirect}) {
    for (size_t i = 0; i < values->size(); ++i) {
      if (max_component((*values)[i]) > 0) lit[i % lit.size()] = 1;
    }
  }
  records->direct = kept(records->direct, lit);
  records->indirect = kept(records->indirect, lit);
  records->entries = records->entries.kept(lit);
}

}  // namespace

std::vector<Rgb> TracedRecords::direct_of(std::span<const int> of_groups,
                                          std::span<const Rgb> gains) const {
  LTE_CHECK(of_groups.size() == gains.size(), "records of light: ", of_groups.size(),
            " groups but ", gains.size(), " gains");
  for (const int group : of_groups)
    LTE_CHECK(group >= 0 && group < groups, "records of light: there is no group ", group);
  std::vector<Rgb> sum(entries.position.size());
  add_groups(direct, sum.size(), of_groups, gains, &sum);
  return sum;
}

std::vector<Rgb> TracedRecords::total_of(std::span<const int> of_groups,
                                         std::span<const Rgb> gains) const {
  std::vector<Rgb> sum = direct_of(of_groups, gains), bounced(sum.size());
  add_groups(indirect, sum.size(), of_groups, gains, &bounced);
  for (size_t i = 0; i < sum.size(); ++i) sum[i] += bounced[i];
  return sum;
}

int64_t TracedRecords::bytes() const {
  constexpr size_t kEntry = 2 * sizeof(Vec3) + sizeof(Rgb) + sizeof(float);
  return static_cast<int64_t>(entries.position.size() * kEntry +
                              (direct.size() + indirect.size()) * sizeof(Rgb));
}

TracedRecords trace_records(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                            const TableSettings& settings, const std::function<void()>& check) {
  LTE_CHECK(settings.paths >= 1, "a table needs a path an entry, got ", settings.paths);
  const bool raw = settings.light == TableLight::Raw;
  const uint64_t places = hash_combine(settings.seed, kPlaces);
  TracedRecords out;
  out.groups = lights.groups();
  // A gather adds a bounce to the table's light, so light of depth 1 is all that none has.
  if (raw && (lights.empty() || settings.max_depth < 2)) return out;
  out.entries = gi::sample_entries(bvh.scene(), settings.entries, places);
  const auto count = static_cast<size_t>(out.entries.size());
  const auto groups = static_cast<size_t>(out.groups);
  out.direct.resize(groups * count);
  out.indirect.resize(groups * count);
  if (lights.empty()) return out;
  pathtrace::IrradianceOptions options;
  options.rays = settings.paths;
  options.max_depth = raw ? settings.max_depth - 1 : 1;
  options.seed = raw ? hash_combine(settings.seed, kLight) : places;
  options.variance = false;
  options.direct_only = options.max_depth == 1;
  for (int64_t first = 0; first < out.entries.size(); first += kBlock) {
    if (check) check();
    const auto begin = static_cast<size_t>(first);
    const auto size = static_cast<size_t>(std::min(kBlock, out.entries.size() - first));
    const pathtrace::Irradiance light = pathtrace::estimate_irradiance(
        bvh, lights, std::span(out.entries.position).subspan(begin, size),
        std::span(out.entries.normal).subspan(begin, size), options, first);
    const auto take = [&](const std::vector<Rgb>& from, std::vector<Rgb>* to) {
      for (size_t g = 0; g < from.size() / size; ++g)
        std::copy_n(from.begin() + static_cast<ptrdiff_t>(g * size), size,
                    to->begin() + static_cast<ptrdiff_t>(g * count + begin));
    };
    take(light.direct, &out.direct);
    take(light.indirect, &out.indirect);
  }
  if (raw) drop_dark(&out);
  return out;
}

}  // namespace lte::infer
