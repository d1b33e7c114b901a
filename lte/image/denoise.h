// Denoising of sampled light: by Open Image Denoise where it is found, else by a filter of lte's.
#pragma once

#include <optional>
#include <string>

#include "lte/image/bilateral.h"
#include "lte/image/oidn.h"

namespace lte::image {

/// Which denoiser to take.
enum class DenoiseBy { Best, OpenImageDenoise, Bilateral };

/// A noisy picture and its guides, all of one size and free of noise but the first.
struct NoisyPicture {
  const Image* light = nullptr;     ///< [height, width, 3]: irradiance, or radiance with `albedo`
  const Image* normal = nullptr;    ///< [height, width, 3] unit; 0 for background
  const Image* position = nullptr;  ///< [height, width, 3] metres
  /// [height, width, 3]: where `light` is reflected radiance and so has the surfaces' texture. The
  /// filter of lte's divides by it; surfaces below 1/1000 are left as they are.
  const Image* albedo = nullptr;
  /// [height, width, 1]: variance of the luminance of irradiance, for the filter of lte's
  /// (BilateralGuides::variance). May be missing.
  const Image* variance = nullptr;
};

class Denoiser {
 public:
  /// Best: Open Image Denoise if it is found.
  /// @throws lte::Error if Open Image Denoise is asked for and not there, with the reasons.
  explicit Denoiser(DenoiseBy by = DenoiseBy::Best);

  bool is_oidn() const { return oidn_.has_value(); }
  /// Which denoiser it is, and why not the better one: for a line of the log.
  const std::string& description() const { return description_; }

  /// The denoised picture; background is 0. Values that are not finite count as 0.
  /// @param quality  of Open Image Denoise
  /// @throws lte::Error if a picture is missing or sizes differ.
  Image denoise(const NoisyPicture& picture, OidnQuality quality = OidnQuality::High) const;

 private:
  std::optional<Oidn> oidn_;
  std::string description_;
};

}  // namespace lte::image
