#include "lte/image/oidn.h"

#include <algorithm>
#include <cstdlib>
#include <mutex>
#include <string_view>
#include <system_error>
#include <utility>

#include <dlfcn.h>

#include "lte/base/check.h"
#include "lte/base/parallel.h"

namespace lte::image {
namespace fs = std::filesystem;
namespace {

constexpr const char* kFile = "libOpenImageDenoise.so.2";
// OIDN_QUALITY_FAST is there from 2.3 on.
constexpr int kMajor = 2, kMinVersion = 20300;
// Larger pictures are denoised in tiles; the library's default takes gigabytes at 4K.
constexpr int kMaxMemoryMb = 768;
// The library's enumerations.
constexpr int kCpuDevice = 1, kFloat3 = 3;
constexpr int kQualities[] = {4, 5, 6};

std::string version_text(int version) {
  return concat(version / 10000, ".", version / 100 % 100, ".", version % 100);
}

void add_folder(const fs::path& folder, std::vector<fs::path>* out) {
  std::error_code ignored;
  if (fs::is_regular_file(folder / kFile, ignored)) out->push_back(folder / kFile);
}

/// PyPI's pyoidn, whatever Python it was installed for.
void add_environment(const fs::path& venv, std::vector<fs::path>* out) {
  std::error_code error;
  for (const auto& python : fs::directory_iterator(venv / "lib", error))
    add_folder(python.path() / "site-packages" / "pyoidn" / "oidn" / "lib", out);
}

/// A library that stays open: its threads may outlive the last device.
void* open_library(const fs::path& library) {
  void* const handle = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (handle != nullptr) return handle;
  const char* const reason = dlerror();
  throw Error(
      concat(library.string(), ": cannot be loaded: ", reason ? reason : "no reason given"));
}

}  // namespace

std::vector<fs::path> oidn_candidates() {
  std::vector<fs::path> out;
  std::error_code ignored;
  if (const char* const chosen = std::getenv("LTE_OIDN"); chosen != nullptr && *chosen != '\0') {
    if (std::string_view(chosen) == "off") return {};
    const fs::path path(chosen);
    return {fs::is_directory(path, ignored) ? path / kFile : path};
  }
  const fs::path folder = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  add_folder(folder, &out);
  add_folder(folder.parent_path() / "lib", &out);
  constexpr std::string_view kSourceVenv = LTE_SOURCE_VENV;  // empty in packages
  if (!kSourceVenv.empty()) add_environment(kSourceVenv, &out);
  out.emplace_back(kFile);
  return out;
}

/// The functions that are used, as the library's C API 2 declares them; handles are opaque.
struct Oidn::Api {
  using Handle = void*;

  explicit Api(const fs::path& library) : library_(open_library(library)), path_(library) {
    load("oidnNewDevice", &new_device);
    load("oidnCommitDevice", &commit_device);
    load("oidnReleaseDevice", &release_device);
    load("oidnGetDeviceInt", &get_device_int);
    load("oidnSetDeviceInt", &set_device_int);
    load("oidnSetDeviceBool", &set_device_bool);
    load("oidnGetDeviceError", &get_device_error);
    load("oidnNewFilter", &new_filter);
    load("oidnSetSharedFilterImage", &set_image);
    load("oidnSetFilterBool", &set_filter_bool);
    load("oidnSetFilterInt", &set_filter_int);
    load("oidnCommitFilter", &commit_filter);
    load("oidnExecuteFilter", &execute_filter);
    load("oidnReleaseFilter", &release_filter);
  }

  Handle (*new_device)(int type) = nullptr;
  void (*commit_device)(Handle device) = nullptr;
  void (*release_device)(Handle device) = nullptr;
  int (*get_device_int)(Handle device, const char* name) = nullptr;
  void (*set_device_int)(Handle device, const char* name, int value) = nullptr;
  void (*set_device_bool)(Handle device, const char* name, bool value) = nullptr;
  int (*get_device_error)(Handle device, const char** message) = nullptr;
  Handle (*new_filter)(Handle device, const char* type) = nullptr;
  void (*set_image)(Handle filter, const char* name, void* data, int format, size_t width,
                    size_t height, size_t byte_offset, size_t pixel_stride,
                    size_t row_stride) = nullptr;
  void (*set_filter_bool)(Handle filter, const char* name, bool value) = nullptr;
  void (*set_filter_int)(Handle filter, const char* name, int value) = nullptr;
  void (*commit_filter)(Handle filter) = nullptr;
  void (*execute_filter)(Handle filter) = nullptr;
  void (*release_filter)(Handle filter) = nullptr;

 private:
  template <typename Function>
  void load(const char* name, Function** function) {
    *function = reinterpret_cast<Function*>(dlsym(library_, name));
    LTE_CHECK(*function != nullptr, path_.string(), ": has no ", name,
              ": expected Open Image Denoise ", version_text(kMinVersion), " or later");
  }

  void* library_;
  fs::path path_;
};

struct Oidn::Device {
  explicit Device(const fs::path& library) : api(library), path(library) {
    handle = api.new_device(kCpuDevice);
    check("no device");
    LTE_CHECK(handle != nullptr, path.string(), ": no device for this processor");
  }
  ~Device() {
    if (handle != nullptr) api.release_device(handle);
  }
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  /// @throws lte::Error with the library's message, if there is one.
  void check(const char* what) const {
    const char* message = nullptr;
    const int code = api.get_device_error(handle, &message);
    LTE_CHECK(code == 0, path.string(), ": ", what, ": ", message ? message : "no message",
              " (error ", code, ")");
  }

  Api api;
  fs::path path;
  Api::Handle handle = nullptr;
  std::mutex mutex;  ///< one filter at a time
};

Oidn::Oidn(const fs::path& library) : device_(std::make_unique<Device>(library)) {
  const Api& api = device_->api;
  const int version = api.get_device_int(device_->handle, "version");
  LTE_CHECK(version >= kMinVersion && version / 10000 == kMajor, library.string(),
            ": is Open Image Denoise ", version_text(version), ": expected ",
            version_text(kMinVersion), " or later of version ", kMajor);
  api.set_device_int(device_->handle, "numThreads", num_threads());
  api.set_device_bool(device_->handle, "setAffinity", false);  // others may be running
  api.commit_device(device_->handle);
  device_->check("no device");
  name_ = concat("Open Image Denoise ", version_text(version));
}

Oidn::Oidn(Oidn&&) noexcept = default;
Oidn& Oidn::operator=(Oidn&&) noexcept = default;
Oidn::~Oidn() = default;

std::optional<Oidn> Oidn::find(std::string* why_not) {
  std::string reasons;
  const std::vector<fs::path> candidates = oidn_candidates();
  if (candidates.empty()) reasons = "LTE_OIDN=off";
  for (const fs::path& candidate : candidates) {
    try {
      return Oidn(candidate);
    } catch (const Error& error) {
      reasons += (reasons.empty() ? "" : "; ") + std::string(error.what());
    }
  }
  if (why_not != nullptr) *why_not = reasons;
  return std::nullopt;
}

Image Oidn::denoise(const Image& noisy, const OidnGuides& guides, OidnQuality quality) const {
  const auto check_size = [&](const Image& image, const char* what) {
    LTE_CHECK(image.channels == 3 && image.width == noisy.width && image.height == noisy.height,
              what, " of ", image.width, "x", image.height, "x", image.channels, ": expected ",
              noisy.width, "x", noisy.height, "x3");
  };
  LTE_CHECK(noisy.width > 0 && noisy.height > 0, "a picture without pixels cannot be denoised");
  check_size(noisy, "a picture");
  LTE_CHECK(guides.normal == nullptr || guides.albedo != nullptr,
            "Open Image Denoise takes no normals without albedo");
  const std::lock_guard lock(device_->mutex);
  const Api& api = device_->api;
  const std::unique_ptr<void, void (*)(void*)> filter(api.new_filter(device_->handle, "RT"),
                                                      api.release_filter);
  device_->check("no filter");
  Image out(noisy.width, noisy.height, 3);
  // The library's interface has no images that are only read.
  const auto set = [&](const char* name, const Image& image) {
    api.set_image(filter.get(), name, const_cast<float*>(image.pixels.data()), kFloat3,
                  static_cast<size_t>(image.width), static_cast<size_t>(image.height), 0, 0, 0);
  };
  set("color", noisy);
  set("output", out);
  if (guides.albedo != nullptr) {
    check_size(*guides.albedo, "albedo");
    set("albedo", *guides.albedo);
  }
  if (guides.normal != nullptr) {
    check_size(*guides.normal, "normals");
    set("normal", *guides.normal);
  }
  api.set_filter_bool(filter.get(), "hdr", true);
  api.set_filter_bool(filter.get(), "cleanAux", guides.albedo != nullptr);
  api.set_filter_int(filter.get(), "quality", kQualities[static_cast<int>(quality)]);
  api.set_filter_int(filter.get(), "maxMemoryMB", kMaxMemoryMb);
  api.commit_filter(filter.get());
  device_->check("the filter cannot be set up");
  api.execute_filter(filter.get());
  device_->check("denoising failed");
  for (float& value : out.pixels) value = std::max(value, 0.0f);
  return out;
}

}  // namespace lte::image
