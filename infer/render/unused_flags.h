// Flags that were given and change nothing: nothing that is typed is passed over in silence.
#pragma once

#include "infer/render/render_request.h"

namespace lte::infer {

/// A note for each flag on the command line that its mode never reads: --quality of a reference
/// say. Before anything is rendered.
void note_unused_flags(const RenderRequest& request);

/// A note on --spp in neural mode, if no pixel of the pictures needed paths of its own.
void note_unused_paths(const RenderRequest& request, int64_t traced_pixels);

}  // namespace lte::infer
