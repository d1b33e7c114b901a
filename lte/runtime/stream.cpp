#include "lte/runtime/device_memory.h"

#if LTE_WITH_CUDA
#include <c10/cuda/CUDAGuard.h>
#include <c10/cuda/CUDAStream.h>

#include "lte/runtime/torch_errors.h"
#include "lte/runtime/torch_parts.h"
#endif

namespace lte::runtime {

#if LTE_WITH_CUDA
struct StreamScope::Guard {
  c10::cuda::CUDAStreamGuard current;
};

StreamScope::StreamScope(Device device, void* stream) {
  LTE_CHECK(!device.is_cpu(), "the model was opened on the CPU: open it on a CUDA device");
  own_errors([&] {
    const auto external = c10::cuda::getStreamFromExternal(static_cast<cudaStream_t>(stream),
                                                           torch_device(device).index());
    guard_ = std::unique_ptr<Guard>(new Guard{c10::cuda::CUDAStreamGuard(external)});
  });
}
#else
struct StreamScope::Guard {};

StreamScope::StreamScope(Device, void*) {
  throw NoDevice(
      "this library was built without CUDA: build lte with LTE_CUDA=ON, or hand over host memory");
}
#endif

StreamScope::~StreamScope() = default;

}  // namespace lte::runtime
