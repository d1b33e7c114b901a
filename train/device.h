// Which device trains.
#pragma once

#include <string>

#include <c10/core/Device.h>

namespace lte::train {

/// "cpu" or "cuda"; logs which one was taken and why.
/// @throws lte::Error if "cuda" cannot be had: there is no silent fallback.
c10::Device choose_device(const std::string& request);

}  // namespace lte::train
