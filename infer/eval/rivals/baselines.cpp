#include "infer/eval/rivals/baselines.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "infer/eval/rivals/blur.h"
#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/runtime/nearest.h"

namespace lte::infer {
namespace {

constexpr const char* kFormat = "lte-baselines";
constexpr int kVersion = 1;
// Normals within 45 degrees of the vertical face up or down.
constexpr float kFacingCosine = 0.70710678f;
// Query points of a scene that enter the fit of the blur: its two figures need no more.
constexpr int64_t kFitPoints = 1024;

int bin_of(const Vec3& position, const Vec3& normal, const Rgb& albedo, const Bounds& bounds) {
  const auto slot = [](float x, int bins) {
    return std::clamp(static_cast<int>(x * static_cast<float>(bins)), 0, bins - 1);
  };
  const float extent = bounds.high.y - bounds.low.y;
  const int height = slot(extent > 0 ? (position.y - bounds.low.y) / extent : 0.0f, kHeightBins);
  const int facing = normal.y > kFacingCosine ? 2 : normal.y < -kFacingCosine ? 0 : 1;
  return (height * kFacingBins + facing) * kAlbedoBins + slot(luminance(albedo), kAlbedoBins);
}

Bounds bounds_of(const data::SceneSample& sample) {
  return {sample.bounds_low, sample.bounds_high};
}

QueryPoints queries_of(const data::SceneSample& sample) {
  return {sample.query_position, sample.query_normal, sample.query_albedo};
}

double mean_of(std::span<const Rgb> values) {
  double sum = 0;
  for (const float value : floats(values)) sum += value;
  return values.empty() ? 0 : sum / (3.0 * static_cast<double>(values.size()));
}

}  // namespace

double mean_emission(const data::SceneSample& s) {
  return runtime::mean_emission(
      {s.scene_position, s.scene_normal, s.scene_albedo, s.scene_emission, s.scene_area});
}

std::filesystem::path baselines_path(const std::filesystem::path& checkpoint) {
  std::filesystem::path path = checkpoint;
  return path.replace_extension(".baselines.json");
}

void write_baselines(const std::filesystem::path& path, const Baselines& b) {
  nlohmann::json table = nlohmann::json::array();
  for (const Rgb& value : b.table) table.push_back({value.x, value.y, value.z});
  const nlohmann::json json = {
      {"format", kFormat},
      {"version", kVersion},
      {"scenes", b.scenes},
      {"constant_mean", {{"mean", b.mean}}},
      {"nearest_point", {{"bins", {kHeightBins, kFacingBins, kAlbedoBins}}, {"table", table}}},
      {"blurred_direct", {{"bandwidth", b.blur_bandwidth}, {"gain", b.blur_gain}}}};
  write_file(path, json.dump(1) + '\n');
}

Baselines read_baselines(const std::filesystem::path& path) {
  Baselines out;
  try {
    const nlohmann::json json = nlohmann::json::parse(read_file(path));
    LTE_CHECK(json.at("format") == kFormat, path.string(), ": not a baselines file");
    LTE_CHECK(json.at("version") == kVersion, path.string(), ": version ",
              json.at("version").dump(), ", expected ", kVersion);
    LTE_CHECK(json.at("nearest_point").at("bins") ==
                  nlohmann::json({kHeightBins, kFacingBins, kAlbedoBins}),
              path.string(), ": nearest_point.bins is ",
              json.at("nearest_point").at("bins").dump());
    out.scenes = json.at("scenes");
    out.mean = json.at("constant_mean").at("mean");
    for (const nlohmann::json& row : json.at("nearest_point").at("table")) {
      out.table.push_back({row.at(0).get<float>(), row.at(1).get<float>(), row.at(2).get<float>()});
    }
    out.blur_bandwidth = json.at("blurred_direct").at("bandwidth");
    out.blur_gain = json.at("blurred_direct").at("gain");
  } catch (const nlohmann::json::exception& error) {
    throw Error(concat(path.string(), ": ", error.what()));
  }
  LTE_CHECK(out.table.size() == size_t{kHeightBins} * kFacingBins * kAlbedoBins, path.string(),
            ": nearest_point.table has ", out.table.size(), " rows, expected ",
            kHeightBins * kFacingBins * kAlbedoBins);
  LTE_CHECK(out.blur_bandwidth > 0, path.string(), ": blurred_direct.bandwidth must be positive");
  return out;
}

void BaselineFit::add(const data::SceneSample& sample) {
  const double factor = 1 / mean_emission(sample);
  const std::vector<Rgb> target = data::sum_groups(sample.indirect, sample.light_groups, factor);
  if (target.empty()) return;
  ++scenes_;
  mean_sum_ += mean_of(target);
  const Bounds bounds = bounds_of(sample);
  for (size_t i = 0; i < target.size(); ++i) {
    std::array<double, 4>& bin = bins_[static_cast<size_t>(
        bin_of(sample.query_position[i], sample.query_normal[i], sample.query_albedo[i], bounds))];
    for (int c = 0; c < 3; ++c) bin[static_cast<size_t>(c)] += target[i][c];
    bin[3] += 1;
  }
  const BlurSources sources(queries_of(sample),
                            data::sum_groups(sample.direct, sample.light_groups, factor));
  std::vector<Vec3> where;
  std::vector<Rgb> wanted;
  for (const int64_t i : spread(sample.query_points(), kFitPoints)) {
    where.push_back(sample.query_position[static_cast<size_t>(i)]);
    wanted.push_back(target[static_cast<size_t>(i)]);
  }
  for (size_t k = 0; k < kBandwidths.size(); ++k) {
    const std::vector<Rgb> blurred =
        sources.blur(where, kBandwidths[k] * max_component(bounds.extent()));
    double cross = 0, square = 0;
    for (size_t i = 0; i < blurred.size(); ++i) {
      cross += dot(blurred[i], wanted[i]);
      square += dot(blurred[i], blurred[i]);
    }
    cross_[k] += cross / static_cast<double>(blurred.size());
    square_[k] += square / static_cast<double>(blurred.size());
  }
}

Baselines BaselineFit::finish() const {
  LTE_CHECK(scenes_ > 0, "baselines need at least one training scene with a light");
  Baselines out;
  out.scenes = scenes_;
  out.mean = mean_sum_ / static_cast<double>(scenes_);
  const auto mean = static_cast<float>(out.mean);
  for (const auto& [r, g, b, count] : bins_) {
    out.table.push_back(count > 0
                            ? Rgb{static_cast<float>(r / count), static_cast<float>(g / count),
                                  static_cast<float>(b / count)}
                            : Rgb{mean, mean, mean});
  }
  // Least squares: with the best gain cross/square, the error is the target's power less
  // cross²/square.
  double best = -1;
  for (size_t k = 0; k < kBandwidths.size(); ++k) {
    if (square_[k] <= 0) continue;
    const double explained = cross_[k] * cross_[k] / square_[k];
    if (explained <= best) continue;
    best = explained;
    out.blur_bandwidth = kBandwidths[k];
    out.blur_gain = cross_[k] / square_[k];
  }
  return out;
}

BaselinePredictor::BaselinePredictor(const Baselines& baselines, const data::SceneSample& sample,
                                     double radiance)
    : baselines_(baselines), sample_(sample), radiance_(radiance) {}

std::vector<Rgb> BaselinePredictor::constant_mean(const QueryPoints& queries) const {
  const auto mean = static_cast<float>(baselines_.mean);
  return std::vector<Rgb>(queries.position.size(), Rgb{mean, mean, mean});
}

std::vector<Rgb> BaselinePredictor::nearest_point(const QueryPoints& queries) const {
  std::vector<Rgb> out(queries.position.size());
  const std::vector<int64_t> nearest =
      runtime::nearest_points(queries.position, sample_.scene_position);
  const Bounds bounds = bounds_of(sample_);
  for (size_t i = 0; i < out.size(); ++i) {
    const auto p = static_cast<size_t>(nearest[i]);
    out[i] = baselines_.table[static_cast<size_t>(bin_of(
        sample_.scene_position[p], sample_.scene_normal[p], sample_.scene_albedo[p], bounds))];
  }
  return out;
}

std::vector<Rgb> BaselinePredictor::blurred_direct(const QueryPoints& queries) const {
  const BlurSources sources(queries_of(sample_),
                            data::sum_groups(sample_.direct, sample_.light_groups, 1 / radiance_));
  const double extent = max_component(bounds_of(sample_).extent());
  std::vector<Rgb> out = sources.blur(queries.position, baselines_.blur_bandwidth * extent);
  for (Rgb& value : out) value *= static_cast<float>(baselines_.blur_gain);
  return out;
}

}  // namespace lte::infer
