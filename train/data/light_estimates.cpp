#include "train/data/light_estimates.h"

#include "lte/base/check.h"

namespace lte::train {

void check_light_estimates(const std::string& file, const nn::ModelConfig& model,
                           const LightEstimates& seen, const LightEstimates& data) {
  if (!model.reads_estimates()) return;
  LTE_CHECK(seen.paths == data.paths && seen.depth == data.depth, file,
            ": its model was trained with light estimates of ", seen.paths, " paths of depth ",
            seen.depth, ", but those of the data set have ", data.paths, " of depth ", data.depth);
}

}  // namespace lte::train
