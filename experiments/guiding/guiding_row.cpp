#include "experiments/guiding/guiding_row.h"

#include "lte/base/text.h"

namespace lte::experiments {

void add_cost(const GuidingCost& cost, GuidingRow* row) {
  row->figures["prediction_seconds"] = cost.prediction;
  row->figures["table_seconds"] = cost.tables;
  row->figures["path_seconds"] = cost.path;
  if (cost.light > 0) row->figures["light_seconds"] = cost.light;
  if (cost.maps > 0) row->figures["maps"] = static_cast<double>(cost.maps);
}

void add_variance(const std::string& prefix, int paths, double relative_variance, double seconds,
                  GuidingRow* row) {
  const std::string of = prefix.empty() ? "relative_" : prefix;
  row->figures[concat(of, "variance_", paths)] = relative_variance;
  row->figures[concat(prefix, "cost_", paths)] = relative_variance * seconds;
}

}  // namespace lte::experiments
