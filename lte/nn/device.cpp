#include "lte/nn/device.h"

#include "lte/base/check.h"
#include "lte/base/log.h"
#include "lte/ops/bf16.h"
#include "lte/tensor/functions.h"
#include "lte/tensor/tensor.h"

namespace lte::nn {

std::string cuda_obstacle() {
  if (!LTE_WITH_CUDA) return "this build has no CUDA operators";
  if (!at::hasCUDA()) return "LibTorch finds no CUDA device";
  return "";
}

c10::Device choose_device(const std::string& request, int gpu, const std::string& setting) {
  const std::string obstacle = cuda_obstacle();
  LTE_CHECK(request.empty() || request == "cpu" || request == "cuda", setting, " ", request,
            ": expected cpu or cuda");
  LTE_CHECK(request != "cuda" || obstacle.empty(), setting, " cuda: ", obstacle, "; use ", setting,
            " cpu, or build with LTE_CUDA=ON where there is a GPU");
  const bool cpu = request == "cpu" || !obstacle.empty();
  const std::string reason = request.empty() ? concat(" (", cpu ? obstacle : "found", ")") : "";
  log_info("device: ", cpu ? "cpu" : "cuda", reason);
  if (cpu) return c10::kCPU;
  const c10::impl::VirtualGuardImpl cuda(c10::kCUDA);
  LTE_CHECK(gpu < cuda.deviceCount(), setting, " cuda: there is no GPU ", gpu, " here, only ",
            cuda.deviceCount());
  const c10::Device device(c10::kCUDA, static_cast<c10::DeviceIndex>(gpu));
  cuda.setDevice(device);
  return device;
}

void warn_of_slow_bf16(const std::string& setting, c10::Device device) {
  if (!device.is_cpu() || ops::has_bf16_products()) return;
  log_warning(setting,
              ": this processor has no bfloat16 products (AVX512-BF16 or AMX); they are made of "
              "float32 instructions, which is slower than float32");
}

}  // namespace lte::nn
