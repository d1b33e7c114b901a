// Pictures of validation views while a run goes on: reference | prediction | difference.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "lte/nn/model.h"
#include "train/data/example.h"

namespace lte::train {

struct PreviewPicture {
  std::string scene;
  int width = 0, height = 0;
  std::vector<unsigned char> png;
};

/// The first view of each validated scene that has one.
class Previews {
 public:
  /// Reads the views of the scenes of `validation`, whose points it shares.
  Previews(const TrainConfig& config, const std::vector<Example>& validation);

  bool empty() const { return views_.empty(); }

  /// Runs the model in evaluation mode and without gradients, and puts its mode back. A picture
  /// shows irradiance without albedo, exposed so that the reference's 99th percentile is white. The
  /// difference is that of luminance, four times as bright.
  std::vector<PreviewPicture> draw(nn::LightTransportModel& model, at::Device device) const;

 private:
  struct ViewExample {
    std::string scene;
    int width, height;
    std::vector<uint8_t> mask;
    nn::PointSet points;
    nn::QuerySet queries;        ///< the pixels whose mask is set
    std::vector<Rgb> reference;  ///< of those pixels, W/m²
    uint64_t seed;
  };
  PreviewPicture draw(const ViewExample& view, nn::LightTransportModel& model,
                      at::Device device) const;

  std::vector<ViewExample> views_;
};

/// The scenes, first of the validation, of which every picture stays; of others the newest alone.
inline constexpr size_t kKeptPreviews = 4;

/// Writes <run>/previews/<scene>.png, the newest picture of each scene, and the first kKeptPreviews
/// a second time as <run>/previews/step_<step>/<scene>.png, where they stay.
/// @throws lte::Error naming the file that cannot be written.
void write_previews(const std::filesystem::path& run, int64_t step,
                    const std::vector<PreviewPicture>& pictures);

}  // namespace lte::train
