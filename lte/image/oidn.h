// Intel's Open Image Denoise 2, found when a program runs: nothing of it is needed to build lte.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lte/image/image.h"

namespace lte::image {

/// Where to look for the library. Files that do not exist are not tried.
///
/// In this order: $LTE_OIDN, the library's file or its folder, which alone counts where it is set
/// ("off": none); the program's folder and ../lib beside it; PyPI's pyoidn in the .venv of the
/// source tree; what the system's loader finds.
std::vector<std::filesystem::path> oidn_candidates();

/// How much time denoising may take.
enum class OidnQuality { Fast, Balanced, High };

/// What a picture is denoised by, beside its own values. Guides must be free of noise.
struct OidnGuides {
  const Image* albedo = nullptr;  ///< in [0, 1]
  const Image* normal = nullptr;  ///< in [−1, 1]; needs albedo
};

/// A device of the library on the processor, with num_threads() threads. Movable. Threads that
/// denoise at the same time wait for one another.
class Oidn {
 public:
  /// Opens the first candidate that works.
  /// @param why_not  what is wrong with the candidates there are, in a line; may be null
  /// @return         nothing if there is none
  static std::optional<Oidn> find(std::string* why_not = nullptr);

  /// @throws lte::Error if the file is no such library, lacks a function, is older than 2.3 or of
  ///         another major version, or finds no processor that it supports.
  explicit Oidn(const std::filesystem::path& library);
  Oidn(Oidn&&) noexcept;
  Oidn& operator=(Oidn&&) noexcept;
  ~Oidn();

  /// "Open Image Denoise 2.5.1".
  const std::string& name() const { return name_; }

  /// Denoises linear values without an upper bound, such as radiance or irradiance.
  /// @param noisy  [height, width, 3], finite and not negative
  /// @return       the same size, not negative
  /// @throws lte::Error if sizes differ or the library reports an error.
  Image denoise(const Image& noisy, const OidnGuides& guides,
                OidnQuality quality = OidnQuality::High) const;

 private:
  struct Api;
  struct Device;
  std::unique_ptr<Device> device_;
  std::string name_;
};

}  // namespace lte::image
