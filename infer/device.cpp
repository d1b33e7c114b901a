#include "infer/device.h"

#include <ATen/Context.h>
#include <ATen/Parallel.h>

#include "lte/base/check.h"
#include "lte/base/log.h"

namespace lte::infer {
namespace {

/// Why CUDA cannot be used; empty if it can.
std::string cuda_obstacle() {
  if (!LTE_WITH_CUDA) return "this build has no CUDA operators";
  if (!at::hasCUDA()) return "LibTorch finds no CUDA device";
  return "";
}

}  // namespace

Device choose_device(const std::string& request) {
  const std::string obstacle = cuda_obstacle();
  LTE_CHECK(request.empty() || request == "cpu" || request == "cuda", "--device ", request,
            ": expected cpu or cuda");
  LTE_CHECK(request != "cuda" || obstacle.empty(), "--device cuda: ", obstacle,
            "; use --device cpu, or build with LTE_CUDA=ON where there is a GPU");
  if (request == "cpu") {
    log_info("device: cpu (asked for)");
    return Device::Cpu;
  }
  if (!obstacle.empty()) {
    log_info("device: cpu (", obstacle, ")");
    return Device::Cpu;
  }
  log_info("device: cuda (", request.empty() ? "found" : "asked for", ")");
  return Device::Cuda;
}

void set_torch_threads(int threads) {
  if (threads > 0) at::set_num_threads(threads);
}

}  // namespace lte::infer
