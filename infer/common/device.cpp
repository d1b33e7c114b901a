#include "infer/common/device.h"

#include <ATen/Parallel.h>

#include "lte/nn/device.h"

namespace lte::infer {

Device choose_device(const std::string& request) {
  return nn::choose_device(request, 0, "--device").is_cuda() ? Device::Cuda : Device::Cpu;
}

void set_torch_threads(int threads) {
  if (threads > 0) at::set_num_threads(threads);
}

}  // namespace lte::infer
