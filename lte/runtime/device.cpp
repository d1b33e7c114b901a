#include "lte/runtime/device.h"

#include <string>

#include <ATen/Parallel.h>
#include <c10/core/impl/VirtualGuardImpl.h>

#include "lte/base/parallel.h"
#include "lte/nn/device.h"

namespace lte::runtime {

c10::Device cuda_device(int number) {
  const std::string obstacle = nn::cuda_obstacle();
  if (!obstacle.empty()) throw NoDevice(concat("device ", number, ": ", obstacle));
  const int count = c10::impl::VirtualGuardImpl(c10::kCUDA).deviceCount();
  if (number >= count) throw NoDevice(concat("device ", number, ": there are only ", count));
  return {c10::kCUDA, static_cast<c10::DeviceIndex>(number)};
}

void set_torch_threads(int threads) {
  if (threads == 0 && at::get_num_threads() > max_threads()) threads = max_threads();
  if (threads > 0) at::set_num_threads(threads);
}

}  // namespace lte::runtime
