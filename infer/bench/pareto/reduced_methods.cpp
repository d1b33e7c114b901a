// Denoised path tracing of every second or fourth pixel along each axis, upsampled as sparse
// answers are: what a user without the network would do for less time.
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "infer/bench/pareto/lit_picture.h"
#include "infer/bench/pareto/method.h"
#include "infer/picture/picture_band.h"
#include "lte/base/timer.h"
#include "lte/gi/upsample.h"
#include "lte/image/denoise.h"
#include "lte/pathtrace/render.h"

namespace lte::infer {
namespace {

using pathtrace::PixelRadiance;
/// The light of a pixel that is wanted.
using PixelLight = Rgb (*)(const PixelRadiance&);

Rgb reflected_light(const PixelRadiance& seen) { return seen.direct + seen.indirect; }
Rgb indirect_light(const PixelRadiance& seen) { return seen.indirect; }

/// A view whose pixels on a grid are path-traced.
class ReducedView {
 public:
  ReducedView(const MethodScene& scene, const scene::Camera& camera, int step, int paths,
              std::shared_ptr<const image::Denoiser> denoiser)
      : scene_(scene),
        camera_(camera),
        step_(step),
        paths_(paths),
        denoiser_(std::move(denoiser)),
        band_(scene.renderer.bvh(), camera, {scene.width, scene.height, 0, scene.height},
              {kAntialias, Metal::Diffuse, false}),
        columns_(step, scene.width),
        rows_(step, scene.height) {
    for (const int32_t query : band_.query_of_pixel()) mask_.push_back(query != scene::kNone);
  }

  void trace() {
    std::vector<int64_t> pixels;
    for (int j = 0; j < rows_.count(); ++j)
      for (int i = 0; i < columns_.count(); ++i)
        pixels.push_back(int64_t{rows_.at(j)} * scene_.width + columns_.at(i));
    grid_ = trace_some(pixels);
  }

  /// Frame::indirect is the light, Frame::emission the rest.
  Frame resolve(PixelLight kind) {
    const gi::PixelSurfaces surfaces = band_.surfaces(mask_);
    std::vector<Rgb> values(mask_.size());
    std::vector<uint8_t> known(mask_.size());
    const image::Image smooth = denoised(kind, surfaces);
    for (int j = 0; j < rows_.count(); ++j) {
      for (int i = 0; i < columns_.count(); ++i) {
        const size_t pixel = surfaces.at(columns_.at(i), rows_.at(j));
        values[pixel] = smooth.rgb(i, j);
        known[pixel] = mask_[pixel];
      }
    }
    const std::vector<int32_t> open = gi::upsample(surfaces, step_, known, values);
    if (open_.size() != open.size())
      open_ = trace_some(std::vector<int64_t>(open.begin(), open.end()));
    for (size_t k = 0; k < open.size(); ++k) {
      const auto pixel = static_cast<size_t>(open[k]);
      values[pixel] = irradiance(kind(open_[k]), pixel);
    }
    BandLight light;
    light.indirect = by_query(surfaces, values);
    return band_.resolve(light);
  }

 private:
  std::vector<PixelRadiance> trace_some(const std::vector<int64_t>& pixels) const {
    return pathtrace::trace_pixels(scene_.renderer.bvh(), scene_.renderer.lights(), camera_,
                                   scene_.width, scene_.height, pixels,
                                   {paths_, scene_.max_depth + 1, scene_.seed});
  }

  Rgb irradiance(const Rgb& radiance, size_t pixel) const {
    const int32_t query = band_.query_of_pixel()[pixel];
    if (query == scene::kNone) return {};
    const Rgb& albedo = band_.queries().albedo[static_cast<size_t>(query)];
    Rgb out;
    for (int c = 0; c < 3; ++c) out[c] = albedo[c] > 1e-3F ? radiance[c] / albedo[c] * kPi : 0;
    return out;
  }

  /// Irradiance on the grid, smoothed by its normals and positions.
  image::Image denoised(PixelLight kind, const gi::PixelSurfaces& surfaces) const {
    const image::Image black(columns_.count(), rows_.count(), 3);
    image::Image light = black, normal = black, position = black;
    for (int j = 0; j < rows_.count(); ++j) {
      for (int i = 0; i < columns_.count(); ++i) {
        const size_t pixel = surfaces.at(columns_.at(i), rows_.at(j));
        if (!mask_[pixel]) continue;
        const PixelRadiance& seen = grid_[static_cast<size_t>(j * columns_.count() + i)];
        light.set_rgb(i, j, irradiance(kind(seen), pixel));
        normal.set_rgb(i, j, surfaces.normal[pixel]);
        position.set_rgb(i, j, surfaces.position[pixel]);
      }
    }
    image::NoisyPicture noisy;
    noisy.light = &light;
    noisy.normal = &normal;
    noisy.position = &position;
    return denoiser_->denoise(noisy);
  }

  /// Queries of anti-aliasing take pixels next to them that see their surface, or else their own.
  std::vector<Rgb> by_query(const gi::PixelSurfaces& surfaces,
                            const std::vector<Rgb>& values) const {
    constexpr int kRadius = 4;
    const QuerySet& queries = band_.queries();
    std::vector<Rgb> out(queries.position.size());
    const auto query = band_.query_of_pixel();
    for (size_t i = 0; i < query.size(); ++i)
      if (query[i] != scene::kNone) out[static_cast<size_t>(query[i])] = values[i];
    auto at = static_cast<size_t>(band_.centre_queries());
    for (const PictureBand::ExtraQuery& extra : band_.extra_queries()) {
      const std::optional<Rgb> near = gi::nearest_known(
          surfaces, extra.pixel % surfaces.width, extra.pixel / surfaces.width,
          {queries.position[at], queries.normal[at], extra.depth}, mask_, values, kRadius);
      out[at++] = near.value_or(values[static_cast<size_t>(extra.pixel)]);
    }
    return out;
  }

  const MethodScene scene_;
  const scene::Camera camera_;
  int step_, paths_;
  std::shared_ptr<const image::Denoiser> denoiser_;
  PictureBand band_;
  gi::GridAxis columns_, rows_;
  std::vector<uint8_t> mask_;        ///< pixels whose centre reflects light
  std::vector<PixelRadiance> grid_;  ///< row by row
  std::vector<PixelRadiance> open_;  ///< pixels that no pixel of the grid stands for
};

}  // namespace

Method reduced_paths(int step, int paths) {
  const std::string share = std::to_string(step * step), count = std::to_string(paths);
  Method method{"reduced-" + share + "-" + count,
                "reduced",
                count + " paths at 1/" + share + " of the pixels, denoised, then upsampled",
                {}};
  method.prepare = [step, paths](const MethodScene& scene, StageTimes* stages) -> RenderView {
    const Timer timer;
    const auto denoiser = std::make_shared<const image::Denoiser>();
    (*stages)[denoiser->is_oidn() ? "Open Image Denoise" : "bilateral filter"] += timer.seconds();
    return [scene, step, paths, denoiser](const scene::Camera& camera, StageTimes* view) {
      Timer stage;
      const auto reduced = std::make_shared<ReducedView>(scene, camera, step, paths, denoiser);
      (*view)["primary"] += stage.seconds();
      stage.restart();
      reduced->trace();
      (*view)["paths"] += stage.seconds();
      stage.restart();
      const Frame frame = reduced->resolve(reflected_light);
      image::Image whole = frame.emission;
      for (size_t i = 0; i < whole.pixels.size(); ++i)
        whole.pixels[i] += frame.albedo.pixels[i] / kPi * frame.indirect.pixels[i];
      (*view)["denoise and upsample"] += stage.seconds();
      return MethodPicture{std::move(whole), [reduced] {
                             return picture_of(reduced->resolve(indirect_light)).indirect();
                           }};
    };
  };
  return method;
}

}  // namespace lte::infer
