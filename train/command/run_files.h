// What of a run directory belongs to the run: files, and folders with all in them.
#pragma once

#include <string>
#include <vector>

namespace lte::train {

/// Checkpoints of earlier steps, checkpoint_STEP.safetensors, belong to it too.
inline const std::vector<std::string> kRunParts = {"checkpoint.safetensors",
                                                   "checkpoint_best.safetensors",
                                                   "model.safetensors",
                                                   "model_best.safetensors",
                                                   "start.safetensors",
                                                   "log.jsonl",
                                                   "config.yaml",
                                                   "find_lr.jsonl",
                                                   "tensorboard",
                                                   "previews",
                                                   ".lock"};

}  // namespace lte::train
