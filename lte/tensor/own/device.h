// There is one device, the CPU. What GPUs need is here by name, so that code for both compiles, and
// is never reached.
#pragma once

#include <cstdint>
#include <ostream>

namespace lte::tensor {

enum class DeviceType : uint8_t { CPU, CUDA };
inline constexpr DeviceType kCPU = DeviceType::CPU, kCUDA = DeviceType::CUDA;
using DeviceIndex = int8_t;

class Device {
 public:
  Device(DeviceType type, DeviceIndex index = -1) : type_(type), index_(index) {}
  bool is_cpu() const { return type_ == kCPU; }
  bool is_cuda() const { return !is_cpu(); }
  DeviceType type() const { return type_; }
  DeviceIndex index() const { return index_; }
  bool operator==(const Device&) const = default;
  friend std::ostream& operator<<(std::ostream& out, const Device& device) {
    return out << (device.is_cpu() ? "cpu" : "cuda");
  }

 private:
  DeviceType type_;
  DeviceIndex index_;
};

struct DeviceGuard {
  explicit DeviceGuard(const Device&) {}
};

struct Stream {};

struct Event {
  explicit Event(DeviceType) {}
  void record(const Stream&) {}
  void block(const Stream&) const {}
};

namespace impl {
struct VirtualGuardImpl {
  explicit VirtualGuardImpl(DeviceType) {}
  DeviceIndex deviceCount() const { return 0; }
  Stream getStream(const Device&) const { return {}; }
  void setDevice(const Device&) const {}
};
}  // namespace impl
inline bool hasCUDA() { return false; }

/// Gradients are LibTorch's: here none are computed.
struct GradMode {
  static constexpr bool is_enabled() { return false; }
};
struct NoGradGuard {
  NoGradGuard() {}
};

}  // namespace lte::tensor

#define C10_HOST_DEVICE
