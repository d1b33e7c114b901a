#include "lte/c_api/stream.h"

#include "lte/c_api/error.h"

#if LTE_WITH_CUDA
#include <c10/cuda/CUDAGuard.h>
#include <c10/cuda/CUDAStream.h>
#endif

namespace lte::c_api {

#if LTE_WITH_CUDA
struct StreamScope::Guard {
  c10::cuda::CUDAStreamGuard current;
};

StreamScope::StreamScope(c10::Device device, void* stream) {
  require(device.is_cuda(), "the model was opened on the CPU: open it on a CUDA device");
  const auto external =
      c10::cuda::getStreamFromExternal(static_cast<cudaStream_t>(stream), device.index());
  guard_ = std::unique_ptr<Guard>(new Guard{c10::cuda::CUDAStreamGuard(external)});
}
#else
struct StreamScope::Guard {};

StreamScope::StreamScope(c10::Device, void*) {
  throw ApiError(LTE_ERROR_NO_CUDA,
                 "this library was built without CUDA: build lte with LTE_CUDA=ON, or hand over "
                 "host memory");
}
#endif

StreamScope::~StreamScope() = default;

}  // namespace lte::c_api
