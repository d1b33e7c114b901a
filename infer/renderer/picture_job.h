// One picture in the making: strips, whose centres' light is sampled at once, and bands of them,
// whose queries are answered and composed.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "infer/light/embedding_draws.h"
#include "infer/picture/frame.h"
#include "infer/picture/picture_band.h"
#include "infer/renderer/centre_light.h"
#include "infer/renderer/checked_pixels.h"
#include "infer/renderer/picture_needs.h"
#include "infer/renderer/pixel_correction.h"
#include "infer/renderer/pixel_paths.h"
#include "infer/renderer/render_settings.h"
#include "infer/renderer/shared_denoiser.h"
#include "lte/gi/sparse_pixels.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights/lights.h"

namespace lte::infer {

/// What a picture is made from. What it does not need may be null.
struct PictureSources {
  const pathtrace::Bvh& bvh;
  const pathtrace::Lights& lights;
  const EmbeddingDraws& draws;
  const gi::RadiosityTable* table;
  KeptViews* kept;
  SharedDenoiser& denoiser;
};

class PictureJob {
 public:
  /// All that is given must outlive it.
  PictureJob(const PictureSources& sources, const scene::Camera& camera,
             const RenderSettings& settings, const PictureNeeds& needs);

  /// @throws lte::Error if the embedding or the table is needed and absent.
  Frame render();

  /// Of the stages that make a picture.
  const StageSeconds& seconds() const { return seconds_; }
  /// image::Denoiser::description() of what took noise away, or nothing.
  const std::string& denoised_by() const { return denoised_by_; }

 private:
  struct PathLight {
    int rays = 0;
    bool direct = true, indirect = true;
  };

  /// @param shown  takes color and depth where nothing else is asked for; null: the layers are
  Frame render_band(const PictureRows& rows, Frame* shown);
  BandLight neural(const PictureBand& band);
  BandLight reference(const PictureBand& band);
  void add_radiance(Frame* frame);
  void check(double seconds);
  void denoise_radiance(const pathtrace::RadianceLayers& layers, Frame* frame);

  void prepare_centres(const PictureRows& strip);
  void correct(const PictureRows& strip, Frame* frame);
  void trace_passes(const std::vector<PixelKind>& kinds, PixelPaths* paths);
  CentreRequest centre_request(const PictureRows& strip);
  const image::Denoiser* denoiser();

  void decode(const PictureBand& band, BandLight* light);
  gi::Answerer decoder() const;
  void estimate(const PictureBand& band, const PathLight& what, BandLight* light);
  void sample_direct(const PictureBand& band, BandLight* light);
  void gather(const PictureBand& band, BandLight* light);
  void trace_metal(const PictureBand& band, BandLight* light);
  void take_centres(const PictureBand& band, const image::Image& known,
                    std::vector<Rgb>* values) const;

  int64_t pixels() const { return int64_t{settings_.width} * settings_.height; }
  void advance(int64_t pixels);

  const PictureSources from_;
  const scene::Camera& camera_;
  const RenderSettings& settings_;
  const PictureNeeds needs_;
  StageSeconds seconds_;
  std::string denoised_by_;
  std::optional<CheckedPixels> checked_;            ///< if their answers are to be checked
  int64_t centre_queries_ = 0, extra_queries_ = 0;  ///< of the bands before

  // Of a strip and the rows around it, from first_row_ on.
  int first_row_ = 0;
  std::optional<pathtrace::GBuffer> hits_;
  std::optional<CentreLight> centres_;
  bool counted_ = false;  ///< what was gathered at centres, in a band
  int64_t untold_ = 0;    ///< of its pixels: nobody was told that they are done

  int64_t band_pixels_ = 0, done_ = 0;  ///< of this band; of them, those that were told of
};

}  // namespace lte::infer
