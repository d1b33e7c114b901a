// The processors that a network runs on.
//
// No header of this folder includes LibTorch but torch_parts.h, tensors.h and torch_errors.h.
#pragma once

#include <string>

#include "lte/base/check.h"

namespace lte::runtime {

/// The CPU, or a GPU of this machine by its number.
struct Device {
  int gpu = -1;  ///< −1: the CPU

  bool is_cpu() const { return gpu < 0; }
  bool operator==(const Device&) const = default;
};

/// There is no such GPU, or none can be used.
class NoDevice : public Error {
 public:
  using Error::Error;
};

/// @param number  of a GPU of this machine, 0 or more
/// @throws NoDevice saying why it cannot be used.
Device cuda_device(int number);

/// Takes a device and logs which one and why. A GPU becomes the current one of this thread.
/// @param request  "cpu", "cuda", or "" to take cuda where it can be had
/// @param setting  what users set to choose, as errors call it: a program's flag
/// @throws lte::Error if "cuda" is asked for and cannot be had.
Device choose_device(const std::string& request, const std::string& setting);

/// Warns where bfloat16 is slower than float32: on a CPU without bfloat16 products.
/// @param setting  that asks for bfloat16; the warning begins with it
void warn_of_slow_bf16(const std::string& setting, Device device);

/// Sets the threads of LibTorch's own pool, to go with lte::set_num_threads(); 0 leaves the
/// default, but for more than lte::max_threads() that OMP_NUM_THREADS asks for: starting those may
/// end the process.
void set_torch_threads(int threads);
int torch_threads();

}  // namespace lte::runtime
