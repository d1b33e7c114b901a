#include "lte/nn/device.h"

#include <ATen/Context.h>

#include "lte/base/check.h"
#include "lte/base/log.h"

namespace lte::nn {
namespace {

/// Why CUDA cannot be used; empty if it can.
std::string cuda_obstacle() {
  if (!LTE_WITH_CUDA) return "this build has no CUDA operators";
  if (!at::hasCUDA()) return "LibTorch finds no CUDA device";
  return "";
}

}  // namespace

c10::Device choose_device(const std::string& request) {
  const std::string obstacle = cuda_obstacle();
  LTE_CHECK(request.empty() || request == "cpu" || request == "cuda", "--device ", request,
            ": expected cpu or cuda");
  LTE_CHECK(request != "cuda" || obstacle.empty(), "--device cuda: ", obstacle,
            "; use --device cpu, or build with LTE_CUDA=ON where there is a GPU");
  const bool cpu = request == "cpu" || !obstacle.empty();
  const std::string reason = request.empty() ? (cpu ? obstacle : "found") : "asked for";
  log_info("device: ", cpu ? "cpu" : "cuda", " (", reason, ")");
  return cpu ? c10::Device(c10::kCPU) : c10::Device(c10::kCUDA);
}

}  // namespace lte::nn
