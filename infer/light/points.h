// The runtime's point arrays, by the names that the tools use.
#pragma once

#include "lte/runtime/points.h"

namespace lte::infer {

using runtime::floats;
using runtime::QueryPoints;
using runtime::ScenePoints;

}  // namespace lte::infer
