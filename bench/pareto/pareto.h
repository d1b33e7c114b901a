// lte_bench pareto: run time against error of every method, on views of scenes.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "bench/pareto/methods.h"
#include "bench/pareto/reference.h"
#include "infer/picture/picture_score.h"
#include "lte/base/stopwatch.h"
#include "lte/cli/scene_flags.h"

namespace lte::bench {

/// Numbers of views whose time is reported: they share the work of Method::prepare().
inline constexpr std::array<int, 3> kViewCounts = {1, 10, 100};

struct ParetoOptions {
  std::vector<std::string> scenes;  ///< files; empty: the shipped Cornell box
  SceneFlags loading;
  std::string checkpoint;  ///< empty: the shipped model
  std::string camera;      ///< as scene::find_cameras() reads it; empty: the scene's first, or auto
  std::vector<std::pair<int, int>> sizes = {{160, 120}};
  std::vector<std::string> methods;  ///< choose_methods()
  int views = 3;
  int repeats = 3;
  int max_depth = 5;
  uint64_t seed = 0;
  int reference_spp = 2048;  ///< paths a pixel, rounded up to an even number
  std::string references;    ///< folder in which references are kept; empty: nowhere
};

struct ParetoRow {
  std::string name, family, settings;
  /// The least of the repeats.
  Seconds once;                         ///< for all views
  Seconds view;                         ///< mean over views
  infer::PictureScore whole, indirect;  ///< means over views
  std::vector<uint64_t> pictures;       ///< checksums by view: equal settings give equal pictures

  double seconds(int views) const { return once.wall + views * view.wall; }
};

/// One scene at one size.
struct ParetoChart {
  std::string scene;
  int width = 0, height = 0;
  int64_t triangles = 0, lights = 0;
  infer::ReferenceNoise whole_noise, indirect_noise;  ///< means over views
  std::vector<ParetoRow> rows;
};

std::vector<ParetoChart> measure_pareto(const ParetoOptions& options);

/// The rows on the Pareto front, in the order of time.
/// @param points  seconds and error of each row; what is not finite is on no front
std::vector<size_t> pareto_front(const std::vector<std::pair<double, double>>& points);

/// `count` views: the cameras that `word` names if they are enough, else the first of them turned
/// about its up axis by 8 degrees and more to both sides.
std::vector<scene::Camera> pareto_views(const pathtrace::Bvh& bvh, const std::string& word,
                                        int count, float aspect);

}  // namespace lte::bench
