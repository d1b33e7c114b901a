// What γ of the query decoder reads of a query j and a neighbour κ.
#pragma once

#include <cstdint>

namespace lte::ops {

/// Columns: the offset o = (p_j − p_κ) * scale, limited; in the longer form n_j · n_κ, n_j · o and
/// n_κ · o after it.
inline constexpr int64_t kOffsetInputs = 3, kNormalInputs = 6;

}  // namespace lte::ops
