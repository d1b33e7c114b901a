// Which device the network runs on.
#pragma once

#include <string>

namespace lte::infer {

enum class Device { Cpu, Cuda };

/// "cpu", "cuda", or "" to let lte choose; logs which one was taken and why.
/// @throws lte::Error if "cuda" is asked for and cannot be had: there is no silent fallback.
Device choose_device(const std::string& request);

/// Threads of LibTorch's own pool, to go with lte::set_num_threads(); 0 leaves the default.
void set_torch_threads(int threads);

}  // namespace lte::infer
