// A stable sort of rows by a 32-bit key.
#pragma once

#include <cstdint>
#include <vector>

namespace lte::ops {

/// Rows 0 .. key.size() - 1 by ascending key; equal keys keep their order. O(N), on one thread.
std::vector<int32_t> sort_rows(const std::vector<uint32_t>& key);

}  // namespace lte::ops
