// Error of a model's incident radiance by direction on a baked data set, beside spherical harmonics
// and spherical Gaussians fitted to the very maps that it is compared with (the paper's supplement,
// section 4).
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "experiments/directions/map_baselines.h"
#include "lte/data/dataset.h"
#include "lte/runtime/memory_limit.h"
#include "lte/runtime/network.h"

namespace lte::experiments {

struct IncidentSettings {
  std::filesystem::path data;
  data::Split split = data::Split::Test;
  /// The same scenes and points with fewer paths a direction, as a rival; empty: none.
  std::filesystem::path traced;
  int64_t scene_points = 0;                     ///< shown to the model; 0: as many as in training
  int highest_degree = 20;                      ///< of the harmonics
  std::vector<int> lobes = {4, 8, 16, 32, 64};  ///< of the Gaussians, rising
  runtime::MemoryLimit memory = {};
};

/// Rows that are kept, one a scene.
inline constexpr size_t kMapRows = 6;

struct IncidentResult {
  int64_t scenes = 0, points = 0, cells = 0;
  MapErrors neural;
  /// The model's irradiance, as if it came evenly from everywhere.
  MapErrors even;
  /// Of models that cast rays: what these see of the scene points, and the model's irradiance where
  /// they meet none.
  MapErrors seen;
  MapErrors traced;         ///< of IncidentSettings::traced
  double traced_paths = 0;  ///< a direction; 0 without
  std::vector<HarmonicErrors> harmonics;
  std::vector<GaussianErrors> gaussians;
  std::vector<MapRow> pictures;
};

/// @throws lte::Error for a model without a radiance decoder, scenes without incident radiance, or
///         a rival of other points
IncidentResult evaluate_incident(const IncidentSettings& settings, const runtime::Network& network);

std::string incident_table(const IncidentResult& result);
std::string incident_json(const IncidentResult& result, const std::string& model,
                          const std::string& data);

}  // namespace lte::experiments
