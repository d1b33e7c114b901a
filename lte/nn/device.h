// Which device the network runs on.
#pragma once

#include <string>

#include <c10/core/Device.h>

namespace lte::nn {

/// "cpu", "cuda", or "" to take cuda where it can be had; logs which one was taken and why.
/// @throws lte::Error if "cuda" is asked for and cannot be had: there is no silent fallback.
c10::Device choose_device(const std::string& request);

}  // namespace lte::nn
