// Which device the network runs on.
#pragma once

#include <string>

#include "lte/tensor/tensor.h"

namespace lte::nn {

/// Why CUDA cannot be used; empty if it can.
std::string cuda_obstacle();

/// Takes a device and logs which one and why. A GPU becomes the current one of this thread.
///
/// @param request  "cpu", "cuda", or "" to take cuda where it can be had
/// @param gpu      which of the machine's
/// @param setting  what users set to choose, as errors call it: a program's flag
/// @throws lte::Error if "cuda" is asked for and cannot be had, or there is no such GPU:
///         there is no silent fallback.
c10::Device choose_device(const std::string& request, int gpu = 0,
                          const std::string& setting = "device");

/// Warns where bfloat16 is slower than float32: on a CPU without bfloat16 products.
/// @param setting  that asks for bfloat16; the warning begins with it
void warn_of_slow_bf16(const std::string& setting, c10::Device device);

}  // namespace lte::nn
