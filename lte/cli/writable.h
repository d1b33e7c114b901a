// Whether an output can be written, asked before the work for it begins.
#pragma once

#include <string>

namespace lte {

/// Nothing for an empty path. A file appears by renaming, so its folder must be writable; a device
/// or a pipe must be so itself.
/// @throws lte::Error naming the path and why it cannot be written
void check_writable(const std::string& path);

}  // namespace lte
