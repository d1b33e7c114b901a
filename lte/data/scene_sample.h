// One baked scene: scene points, query points, ground truth by light group, and views. DESIGN
// section 6.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "lte/base/math.h"
#include "lte/data/incident_field.h"

namespace lte::data {

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
  std::vector<Rgb>
      path_traced_64;  ///< [H * W], indirect irradiance with 64 rays a pixel: the rival
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
  /// As scene::Material has them; both empty where nothing is metal.
  std::vector<float> scene_metallic, scene_roughness;
  // Query points, [N]
  std::vector<Vec3> query_position, query_normal, query_albedo;
  int64_t light_groups = 0;           ///< G
  std::vector<Rgb> direct, indirect;  ///< [G, N], irradiance in W/m² at unit gain
  std::vector<float> variance;        ///< [N], of the mean indirect irradiance
  std::vector<int32_t> query_rays;    ///< [N], paths a point where they differ, else empty
  std::vector<Rgb>
      path_traced_64;  ///< [N], indirect irradiance with 64 rays: the rival (may be empty)
  std::vector<View> views;
  IncidentField incident;  ///< at points of its own; may be empty
  // Where it came from
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

/// Atomic; metadata: format "lte-scene", version, name, seed, rays, max_depth, views, bounds.
/// Values are held to what read_scene_sample() accepts.
/// @throws lte::Error if array lengths disagree, a value is out of range or the file cannot be
/// written.
void write_scene_sample(const std::filesystem::path& path, const SceneSample& sample);

/// @throws lte::Error naming file, tensor and index of the first offender: truncated, foreign,
/// wrong shape, non-finite,
///         negative irradiance, light group out of range, normal not unit.
SceneSample read_scene_sample(const std::filesystem::path& path);

/// Removes the query points that no picture asks about: those that no traced path has connected to
/// a light (direct and indirect irradiance exactly zero in every group), the insides of closed
/// furniture and the like, one point in ten of a furnished room; and those on surfaces that reflect
/// nothing, which the renderer leaves out too, with the pixels that show such surfaces, which leave
/// the views' masks. A relative loss would spend most of its gradient on telling the zero of the
/// first from a small number; the second, panes behind a sunlit blind among them, can be brighter
/// than all else. A sample of which no point would stay keeps them all.
/// @return  how many points were removed
int64_t drop_idle_queries(SceneSample* sample);

}  // namespace lte::data
