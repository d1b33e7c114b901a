// TorchScript source of the light that models have solved on their scene points.
#pragma once

#include <string>

namespace lte::torchscript {

/// The method solve_light(points [M, 13 or more]) -> [M, 12], whose columns are those of
/// ops::SolvedColumn, and what it calls besides.
/// @param portable  built-in operators alone: agrees with lte/radiosity but where rounding decides
///                  whether two points see each other
std::string solved_light_source(bool portable);

}  // namespace lte::torchscript
