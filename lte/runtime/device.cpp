#include "lte/runtime/device.h"

#include "lte/base/parallel.h"
#include "lte/nn/device.h"
#include "lte/runtime/torch_parts.h"
#include "lte/tensor/tensor.h"

namespace lte::runtime {

c10::Device torch_device(Device device) {
  if (device.is_cpu()) return c10::kCPU;
  return {c10::kCUDA, static_cast<c10::DeviceIndex>(device.gpu)};
}

Device device_of(c10::Device device) { return device.is_cpu() ? Device{} : Device{device.index()}; }

Device cuda_device(int number) {
  const std::string obstacle = nn::cuda_obstacle();
  if (!obstacle.empty()) throw NoDevice(concat("device ", number, ": ", obstacle));
  const int count = c10::impl::VirtualGuardImpl(c10::kCUDA).deviceCount();
  if (number >= count) throw NoDevice(concat("device ", number, ": there are only ", count));
  return {number};
}

Device choose_device(const std::string& request, const std::string& setting) {
  return device_of(nn::choose_device(request, 0, setting));
}

void warn_of_slow_bf16(const std::string& setting, Device device) {
  nn::warn_of_slow_bf16(setting, torch_device(device));
}

void set_torch_threads(int threads) {
  if (threads == 0 && at::get_num_threads() > max_threads()) threads = max_threads();
  if (threads > 0) at::set_num_threads(threads);
}

int torch_threads() { return at::get_num_threads(); }

}  // namespace lte::runtime
