#include "train/data/solved_light.h"

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "lte/base/check.h"
#include "lte/base/checksum.h"
#include "lte/base/log.h"
#include "lte/base/safetensors.h"

namespace lte::train {
namespace {

using radiosity::PointIrradiance;

constexpr const char* kFingerprintKey = "fingerprint";

/// Calls visit(name, values) for every part of a solution.
template <typename Light, typename Visitor>
void for_each_part(Light& light, Visitor&& visit) {
  visit("direct", light.direct);
  visit("indirect", light.indirect);
  visit("direct_back", light.direct_back);
  visit("indirect_back", light.indirect_back);
}

/// Of all that a solution follows from.
std::string fingerprint_of(const radiosity::Points& points, int64_t groups) {
  Checksum sum;
  const auto add = [&](auto values) { sum.add(values.data(), values.size_bytes()); };
  add(points.position);
  add(points.normal);
  add(points.albedo);
  add(points.emission);
  add(points.area);
  add(points.light_group);
  sum.add(concat(groups, " ", radiosity::kSolverVersion));
  return sum.text();
}

/// @throws lte::Error if the file is missing, damaged or of other shapes
PointIrradiance read_light(const std::filesystem::path& path, int64_t groups, int64_t points) {
  const SafetensorsFile file(path);
  file.verify();
  PointIrradiance light;
  for_each_part(light, [&](const char* part, std::vector<Rgb>& values) {
    const auto* kept =
        reinterpret_cast<const Rgb*>(file.values<float>(part, {groups, points, 3}).data());
    values.assign(kept, kept + groups * points);
  });
  return light;
}

/// Null if there is none, or one of another fingerprint.
std::optional<PointIrradiance> kept_light(const std::filesystem::path& path,
                                          const std::string& fingerprint, int64_t groups,
                                          int64_t points) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return std::nullopt;
  try {
    if (SafetensorsFile(path).metadata(kFingerprintKey) != fingerprint) return std::nullopt;
    return read_light(path, groups, points);
  } catch (const Error& error) {
    log_warning(error.what(), "; its light is solved again");
    return std::nullopt;
  }
}

void keep_light(const std::filesystem::path& path, const std::string& fingerprint, int64_t groups,
                int64_t points, const PointIrradiance& light) {
  SafetensorsWriter writer;
  for_each_part(light, [&](const char* part, const std::vector<Rgb>& values) {
    writer.add(part, {groups, points, 3}, reinterpret_cast<const float*>(values.data()));
  });
  writer.set_metadata(kFingerprintKey, fingerprint);
  try {
    std::filesystem::create_directories(path.parent_path());
    writer.write(path);
  } catch (const std::exception& error) {  // a missing copy costs time alone
    log_warning(path.string(), ": light that was solved cannot be kept: ", error.what());
  }
}

}  // namespace

PointIrradiance solved_light(const std::filesystem::path& folder, const std::string& name,
                             const radiosity::Points& points, int64_t groups) {
  if (folder.empty()) return radiosity::solve(points, groups);
  const std::filesystem::path path = folder / (name + ".safetensors");
  const std::string fingerprint = fingerprint_of(points, groups);
  const auto count = static_cast<int64_t>(points.position.size());
  if (std::optional<PointIrradiance> kept = kept_light(path, fingerprint, groups, count))
    return *std::move(kept);
  PointIrradiance light = radiosity::solve(points, groups);
  keep_light(path, fingerprint, groups, count, light);
  return light;
}

}  // namespace lte::train
