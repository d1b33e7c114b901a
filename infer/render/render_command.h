// What lte_render does between its command line and its exit code.
#pragma once

#include "infer/render/render_request.h"

namespace lte::infer {

/// Loads, renders, writes, and prints one line of times.
/// @throws lte::Error for bad input, CLI::ValidationError for flags that do not go together.
void run_render(const RenderRequest& request);

}  // namespace lte::infer
