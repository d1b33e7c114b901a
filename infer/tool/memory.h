// What --max-memory says.
#pragma once

#include <string>

#include "lte/runtime/memory_limit.h"

namespace lte::infer {

using runtime::decode_mb;
using runtime::encode_mb;
using runtime::kQueryBlock;
using runtime::memory_text;
using runtime::MemoryLimit;

/// "500M", "2G", "1.5g", "800K" in binary units, or a plain number of MiB -> MiB; 0 for no limit.
/// @throws lte::Error naming the text if it is anything else.
double parse_memory(const std::string& text);

}  // namespace lte::infer
