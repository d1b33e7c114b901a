// The version of lte.
#pragma once

namespace lte {

/// "0.1.0"; goes into every file that a tool writes.
const char* version();

}  // namespace lte
