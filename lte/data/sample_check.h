// What makes a scene sample valid: array lengths and the range of every value. Reader and writer
// share it, so that no file is written that would be refused later.
#pragma once

#include <string>

#include "lte/data/scene_sample.h"

namespace lte::data {

/// @param file  the file's name, for messages
/// @throws lte::Error naming file, tensor and index of the first offender.
void check_sample(const std::string& file, const SceneSample& sample);

}  // namespace lte::data
