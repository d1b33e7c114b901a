// A caller's CUDA stream as LibTorch's current one.
#pragma once

#include <memory>

#include <c10/core/Device.h>

namespace lte::c_api {

/// While it lives, operators of this thread run on `stream` of `device`.
class StreamScope {
 public:
  /// @param stream  a cudaStream_t of `device`; null is its default stream
  /// @throws ApiError in builds without CUDA, or if `device` is not a GPU.
  StreamScope(c10::Device device, void* stream);
  ~StreamScope();
  StreamScope(const StreamScope&) = delete;
  StreamScope& operator=(const StreamScope&) = delete;

 private:
  struct Guard;
  std::unique_ptr<Guard> guard_;
};

}  // namespace lte::c_api
