// One baked scene: scene points, query points, ground truth by light group, and views
// (docs/dataset.md).
//
// A new tensor is a member here and a line in one of the lists below, which the writer, the reader
// and the checks share.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "lte/base/half.h"
#include "lte/base/math.h"
#include "lte/data/incident_field.h"
#include "lte/data/tensor_rule.h"

namespace lte::data {

/// Format version that is written, and the newest that is read.
inline constexpr int kSceneSampleVersion = 1;

/// Paths a pixel of View::path_traced_few.
inline constexpr std::array<int, 3> kFewPaths = {16, 4, 1};

/// A G-buffer of primary hits with reference irradiance, so that evaluation needs neither Embree
/// nor the scene. Stored as view<k>_position, ... [H, W, 3] and view<k>_mask [H, W] uint8.
struct View {
  int width = 0, height = 0;
  std::vector<Vec3> position, normal, albedo;  ///< [H * W]; zero where mask is 0
  std::vector<uint8_t> mask;                   ///< [H * W]
  std::vector<Rgb> direct, indirect;           ///< [G, H * W], irradiance at unit gain
  std::vector<float> variance;                 ///< [H * W], of the mean indirect irradiance
  /// [H * W], indirect irradiance with 64 rays a pixel: what a network is compared with.
  std::vector<Rgb> path_traced_64;
  /// The same with kFewPaths[i] rays a pixel, each drawn by itself: view<k>_path_traced_16, ...
  /// Each may be empty, as in files of earlier versions.
  std::array<std::vector<Rgb>, kFewPaths.size()> path_traced_few;
};

struct SceneSample {
  std::string name;
  // Scene points, [M]
  std::vector<Vec3> scene_position, scene_normal, scene_albedo, scene_emission;
  std::vector<float> scene_area;     ///< m²
  std::vector<int32_t> scene_light;  ///< light group, −1 for none
  /// [G, M], W/m² at unit gain: noisy irradiance by depth 1 and by later ones, both sides of the
  /// surface together, 0 at luminaires (pathtrace::estimate_light()). Both empty in files of
  /// earlier versions.
  std::vector<Rgb> scene_direct, scene_indirect;
  /// Of these, what falls on the side that the normal leaves behind; and the standard error of
  /// indirect irradiance on either side over its value (pathtrace::LightEstimates). All empty in
  /// files of earlier versions.
  std::vector<Rgb> scene_direct_back, scene_indirect_back;
  std::vector<Half> scene_error, scene_error_back;
  /// As scene::Material has them; both empty where nothing is metal.
  std::vector<float> scene_metallic, scene_roughness;
  // Query points, [N]
  std::vector<Vec3> query_position, query_normal, query_albedo;
  int64_t light_groups = 0;           ///< G
  std::vector<Rgb> direct, indirect;  ///< [G, N], irradiance in W/m² at unit gain
  std::vector<float> variance;        ///< [N], of the mean indirect irradiance
  std::vector<int32_t> query_rays;    ///< [N], paths a point where they differ, else empty
  /// [N], indirect irradiance with 64 rays, which a network is compared with; may be empty.
  std::vector<Rgb> path_traced_64;
  std::vector<View> views;
  IncidentField incident;  ///< at points of its own; may be empty
  // Where it came from
  /// scene::Fingerprint::geometry of the scene; empty in files of earlier versions.
  std::string geometry;
  uint64_t seed = 0;
  int64_t rays = 0;         ///< paths a query point; their mean where they differ
  double target_error = 0;  ///< that decided them, relative to the mean; 0 for a fixed number
  int max_depth = 5;
  /// Points drawn besides those above and left out, as light cannot reach them.
  int64_t pruned_scene_points = 0, pruned_query_points = 0;
  Vec3 bounds_low, bounds_high;  ///< world, of the scene

  int64_t scene_points() const { return static_cast<int64_t>(scene_position.size()); }
  int64_t query_points() const { return static_cast<int64_t>(query_position.size()); }
};

template <typename Sample, typename Visitor>
void for_each_scene_tensor(Sample& sample, Visitor&& visit) {
  using enum Values;
  const int64_t M = sample.scene_points(), G = sample.light_groups;
  visit({"scene_position", {M}, Finite}, sample.scene_position);
  visit({"scene_normal", {M}, Unit}, sample.scene_normal);
  visit({"scene_albedo", {M}, Albedo}, sample.scene_albedo);
  visit({"scene_emission", {M}, NonNegative}, sample.scene_emission);
  visit({"scene_area", {M}, NonNegative}, sample.scene_area);
  visit({"scene_light", {M}, LightGroup}, sample.scene_light);
  visit({"scene_direct", {G, M}, NonNegative, "scene_direct"}, sample.scene_direct);
  visit({"scene_indirect", {G, M}, NonNegative, "scene_direct"}, sample.scene_indirect);
  const std::string back = "scene_direct_back";
  visit({back, {G, M}, NonNegative, back}, sample.scene_direct_back);
  visit({"scene_indirect_back", {G, M}, NonNegative, back}, sample.scene_indirect_back);
  visit({"scene_error", {G, M}, Share, back}, sample.scene_error);
  visit({"scene_error_back", {G, M}, Share, back}, sample.scene_error_back);
  visit({"scene_metallic", {M}, Share, "scene_metallic"}, sample.scene_metallic);
  visit({"scene_roughness", {M}, Share, "scene_metallic"}, sample.scene_roughness);
}

/// The last axis of each shape is that of the query points.
template <typename Sample, typename Visitor>
void for_each_query_tensor(Sample& sample, Visitor&& visit) {
  using enum Values;
  const int64_t N = sample.query_points(), G = sample.light_groups;
  visit({"query_position", {N}, Finite}, sample.query_position);
  visit({"query_normal", {N}, Unit}, sample.query_normal);
  visit({"query_albedo", {N}, Albedo}, sample.query_albedo);
  visit({"direct", {G, N}, NonNegative}, sample.direct);
  visit({"indirect", {G, N}, NonNegative}, sample.indirect);
  visit({"variance", {N}, NonNegative}, sample.variance);
  visit({"query_rays", {N}, NonNegative, "query_rays"}, sample.query_rays);
  visit({"path_traced_64", {N}, NonNegative, "path_traced_64"}, sample.path_traced_64);
}

/// @param k  the view's place among the views
template <typename AnyView, typename Visitor>
void for_each_view_tensor(AnyView& view, size_t k, int64_t light_groups, Visitor&& visit) {
  using enum Values;
  const std::string prefix = "view" + std::to_string(k) + "_";
  const int64_t H = view.height, W = view.width, G = light_groups;
  visit({prefix + "mask", {H, W}, Mask}, view.mask);
  visit({prefix + "position", {H, W}, Finite, {}, &view.mask}, view.position);
  visit({prefix + "normal", {H, W}, Unit, {}, &view.mask}, view.normal);
  visit({prefix + "albedo", {H, W}, Albedo, {}, &view.mask}, view.albedo);
  visit({prefix + "direct", {G, H, W}, NonNegative, {}, &view.mask}, view.direct);
  visit({prefix + "indirect", {G, H, W}, NonNegative, {}, &view.mask}, view.indirect);
  visit({prefix + "variance", {H, W}, NonNegative}, view.variance);
  const auto visit_path_traced = [&](int paths, auto& values) {
    const std::string name = prefix + "path_traced_" + std::to_string(paths);
    visit({name, {H, W}, NonNegative, name}, values);
  };
  visit_path_traced(64, view.path_traced_64);
  for (size_t i = 0; i < kFewPaths.size(); ++i)
    visit_path_traced(kFewPaths[i], view.path_traced_few[i]);
}

/// Calls visit(const TensorRule&, std::vector<T>&) for every tensor that the sample may have, with
/// T one of Vec3, float, int32_t, uint8_t and Half. Optional tensors are visited too while they are
/// empty; those of incident radiance are visited if the sample has any.
///
/// Shapes follow from the numbers of scene points, query points, light groups and views, the sizes
/// of the views, and `incident`'s bins and points: whoever fills a sample sets these first.
/// @param sample  SceneSample, const or not
template <typename Sample, typename Visitor>
void for_each_tensor(Sample& sample, Visitor&& visit) {
  for_each_scene_tensor(sample, visit);
  for_each_query_tensor(sample, visit);
  for (size_t k = 0; k < sample.views.size(); ++k)
    for_each_view_tensor(sample.views[k], k, sample.light_groups, visit);
  if (!sample.incident.empty())
    for_each_incident_tensor(sample.incident, sample.light_groups, visit);
}

/// Atomic; metadata: format "lte-scene", version, name, seed, rays, max_depth, views, bounds.
/// Values are held to what read_scene_sample() accepts.
/// @throws lte::Error if array lengths disagree, a value is out of range or the file cannot be
/// written.
void write_scene_sample(const std::filesystem::path& path, const SceneSample& sample);

/// @throws lte::Error naming file, tensor and index of the first offender: truncated, foreign,
/// wrong shape, non-finite, negative irradiance, light group out of range, normal not unit.
SceneSample read_scene_sample(const std::filesystem::path& path);

}  // namespace lte::data
