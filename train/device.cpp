#include "train/device.h"

#include <ATen/Context.h>

#include "lte/base/check.h"
#include "lte/base/log.h"

namespace lte::train {

c10::Device choose_device(const std::string& request) {
  LTE_CHECK(request == "cpu" || request == "cuda", "--device ", request, ": expected cpu or cuda");
  if (request == "cpu") {
    log_info("device: cpu");
    return c10::Device(c10::kCPU);
  }
  constexpr bool kBuilt = LTE_WITH_CUDA != 0;
  LTE_CHECK(kBuilt,
            "--device cuda: this build has no CUDA operators; use --device cpu, or build with "
            "LTE_CUDA=ON");
  LTE_CHECK(at::hasCUDA(), "--device cuda: LibTorch finds no CUDA device; use --device cpu");
  log_info("device: cuda (asked for)");
  return c10::Device(c10::kCUDA);
}

}  // namespace lte::train
