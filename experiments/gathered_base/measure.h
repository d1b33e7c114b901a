// Errors of gathered irradiance at points, by table of light and number of rays, beside the network
// asked at the points themselves.
#pragma once

#include <string>
#include <vector>

#include "experiments/gathered_base/light_tables.h"
#include "experiments/gathered_base/queries.h"

namespace lte::experiments {

/// One way of answering.
struct AnswerRow {
  std::string name;
  int rays = 0;  ///< a point; 0: none
  double mse = 0, worth = 0, mean_ratio = 0;
  double microseconds = 0;  ///< of processors, a point
};

/// What is wrong with a table, whatever the rays: from two gathers of the most rays.
struct TableRow {
  std::string name;
  double seconds = 0;  ///< to make it
  double bias = 0;     ///< mean squared error that both gathers share; noise can make it negative
};

struct Measured {
  double mean = 0;  ///< of the references
  std::vector<AnswerRow> answers;
  std::vector<TableRow> tables;
};

struct MeasureOptions {
  std::vector<int> rays{4, 8, 16, 64};
  int max_depth = 5;
  uint64_t seed = 0;
};

Measured measure(const render::TracedScene& scene, const LightTables& maker,
                 const std::vector<LightTable>& tables, const runtime::SceneEmbedding& embedding,
                 const Queries& queries, const MeasureOptions& options);

}  // namespace lte::experiments
