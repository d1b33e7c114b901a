// What a way of drawing paths is worth: its variance, and what it costs, variance times seconds.
#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace lte::experiments {

struct GuidingOptions {
  int width = 320, height = 240;  ///< of the picture whose pixels share maps
  double radius_m = 0.25;         ///< from a shared map's point at most
  int columns = 24, rows = 18;    ///< pixels that are looked at
  int64_t paths = 1024;           ///< of each and each way of drawing
  int64_t query_points = 8192;    ///< of the scene, which share maps; each sixteenth is measured
};

/// A way of drawing, measured.
struct GuidingRow {
  std::string name;
  int64_t paths = 0;   ///< that were drawn
  double seconds = 0;  ///< of the processor, for these
  std::map<std::string, double> figures;
};

/// Processor seconds that one way of drawing takes.
struct GuidingCost {
  double prediction = 0;  ///< for each pixel or point, whatever the paths: maps
  double tables = 0;      ///< likewise: finding its map, and the distribution over its cells
  double path = 0;        ///< for each path
  double light = 0;       ///< for each light sample
  int64_t maps = 0;       ///< that were made

  double of(int paths, bool lights) const {
    return prediction + tables + paths * (path + (lights ? light : 0));
  }
};

/// Adds the seconds to a row.
void add_cost(const GuidingCost& cost, GuidingRow* row);

/// Adds the variance of the mean of so many paths, and that times the seconds which they take: the
/// variance of a fixed time is in proportion to it.
/// @param prefix  "" or "whole_", of the figures' names: relative_variance_8 and cost_8
void add_variance(const std::string& prefix, int paths, double relative_variance, double seconds,
                  GuidingRow* row);

}  // namespace lte::experiments
