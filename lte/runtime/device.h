// The processors that a network runs on.
#pragma once

#include <c10/core/Device.h>

#include "lte/base/check.h"

namespace lte::runtime {

/// There is no such GPU, or none can be used.
class NoDevice : public Error {
 public:
  using Error::Error;
};

/// @param number  of a GPU of this machine, 0 or more
/// @throws NoDevice saying why it cannot be used.
c10::Device cuda_device(int number);

/// Sets the threads of LibTorch's own pool, to go with lte::set_num_threads(); 0 leaves the
/// default, but for more than lte::max_threads() that OMP_NUM_THREADS asks for: starting those may
/// end the process.
void set_torch_threads(int threads);

}  // namespace lte::runtime
