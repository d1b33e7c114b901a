#include "lte/pathtrace/render.h"

#include <algorithm>
#include <array>
#include <memory>
#include <numeric>
#include <vector>

#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/pathtrace/blocks/path_sampler.h"
#include "lte/pathtrace/transport/transport.h"
#include "lte/scene/camera_rays.h"

namespace lte::pathtrace {
namespace {

/// Traces pixels in blocks of paths that may hold several pixels or a part of one.
class PixelTracer : public LightSink {
 public:
  PixelTracer(const Bvh& bvh, const Lights& lights, const scene::Camera& camera, int width,
              int height, const RenderOptions& options)
      : rays_(camera),
        options_(options),
        row_(width),
        width_(static_cast<float>(width)),
        height_(static_cast<float>(height)),
        origin_(camera.origin - bvh.handles().origin),
        sampler_(Sampling::Sobol, std::max(options.spp, options.in_all)),
        transport_(bvh, lights, options.max_depth, kRouletteDepth, *this) {}

  /// Fills `out`, an entry a pixel.
  void trace(std::span<const int64_t> pixels, std::span<PixelRadiance> out) {
    sums_.assign(pixels.size(), {});
    for (size_t i = 0; i < pixels.size(); ++i) {
      sampler_.start_stream(options_.seed, static_cast<uint64_t>(pixels[i]));
      sampler_.start_set();
      sampler_.skip_paths(static_cast<uint32_t>(options_.had));
      for (int k = 0; k < options_.spp; ++k) {
        if (sampler_.paths() == kBlock) flush(pixels);
        entry_[static_cast<size_t>(sampler_.paths())] = static_cast<int>(i);
        sampler_.add_path();
      }
    }
    flush(pixels);
    for (size_t i = 0; i < pixels.size(); ++i)
      out[i] = {mean(sums_[i][0]), mean(sums_[i][1]), mean(sums_[i][2])};
  }

  void add(int depth, std::span<const Contribution> contributions) override {
    const size_t part = static_cast<size_t>(std::min(depth, 3)) - 1;
    for (const Contribution& c : contributions) {
      Sum& sum = sums_[static_cast<size_t>(entry_[static_cast<size_t>(c.path)])][part];
      sum.x += c.value.x;
      sum.y += c.value.y;
      sum.z += c.value.z;
    }
  }

 private:
  static constexpr int kRouletteDepth = 4;  // that of irradiance, counted from the camera
  struct Sum {
    double x = 0, y = 0, z = 0;
  };

  Rgb mean(const Sum& sum) const {
    const double count = options_.spp;
    return {static_cast<float>(sum.x / count), static_cast<float>(sum.y / count),
            static_cast<float>(sum.z / count)};
  }

  void flush(std::span<const int64_t> pixels) {
    const int count = sampler_.paths();
    std::array<int32_t, kBlock> all;
    std::iota(all.begin(), all.end(), 0);
    sampler_.direction(0, all.data(), count, &jitter_);
    for (int lane = 0; lane < count; ++lane) {
      const int64_t pixel = pixels[static_cast<size_t>(entry_[static_cast<size_t>(lane)])];
      const int64_t column = pixel % row_, row = pixel / row_;
      const auto x = static_cast<float>(column), y = static_cast<float>(row);
      transport_.start().origin.put(lane, origin_);
      transport_.start().direction.put(
          lane, rays_.direction((x + to_unit(jitter_.x[lane])) / width_,
                                (y + to_unit(jitter_.y[lane])) / height_, width_ / height_));
    }
    transport_.trace_from_camera(sampler_);
    sampler_.clear();
  }

  scene::CameraRays rays_;
  const RenderOptions& options_;
  const int64_t row_;
  const float width_, height_;
  const Vec3 origin_;
  PathSampler sampler_;
  Transport transport_;
  DirectionNumbers jitter_;
  std::array<int32_t, kBlock> entry_;  ///< of a path: its place in `pixels`
  std::vector<std::array<Sum, 3>> sums_;
};

void check_tracing(const Bvh& bvh, const Lights& lights, const RenderOptions& options) {
  LTE_CHECK(&bvh.scene() == &lights.scene(), "the BVH and the lights are of two scenes");
  LTE_CHECK(options.spp >= 1, "spp must be at least 1, got ", options.spp);
  LTE_CHECK(options.had >= 0 && options.had <= kMaxPaths - options.spp && options.in_all >= 0 &&
                options.in_all <= kMaxPaths,
            "paths of all calls must be 0 to ", kMaxPaths);
  LTE_CHECK(options.max_depth >= 1, "max_depth must be at least 1, got ", options.max_depth);
}

}  // namespace

image::Image render_reference(const Bvh& bvh, const Lights& lights, const scene::Camera& camera,
                              int width, int height, const RenderOptions& options,
                              const PixelsDone& done, RadianceLayers* layers) {
  check_view(camera, width, height);
  check_tracing(bvh, lights, options);
  image::Image out(width, height, 3);
  if (layers != nullptr) layers->emission = layers->direct = layers->indirect = out;
  if (lights.empty()) return out;
  parallel_for(height, 1, [&](int64_t begin, int64_t end) {
    const auto tracer = std::make_unique<PixelTracer>(bvh, lights, camera, width, height, options);
    std::vector<int64_t> pixels(static_cast<size_t>(width));
    std::vector<PixelRadiance> row(pixels.size());
    for (int64_t y = begin; y < end; ++y) {
      std::iota(pixels.begin(), pixels.end(), y * width);
      tracer->trace(pixels, row);
      for (int x = 0; x < width; ++x) {
        const PixelRadiance& seen = row[static_cast<size_t>(x)];
        out.set_rgb(x, static_cast<int>(y), seen.emission + seen.direct + seen.indirect);
        if (layers == nullptr) continue;
        layers->emission.set_rgb(x, static_cast<int>(y), seen.emission);
        layers->direct.set_rgb(x, static_cast<int>(y), seen.direct);
        layers->indirect.set_rgb(x, static_cast<int>(y), seen.indirect);
      }
      if (done) done(width);
    }
  });
  return out;
}

std::vector<PixelRadiance> trace_pixels(const Bvh& bvh, const Lights& lights,
                                        const scene::Camera& camera, int width, int height,
                                        std::span<const int64_t> pixels,
                                        const RenderOptions& options, const PixelsDone& done) {
  check_view(camera, width, height);
  check_tracing(bvh, lights, options);
  std::vector<PixelRadiance> out(pixels.size());
  if (lights.empty()) return out;
  constexpr int64_t kPixels = 256;
  parallel_for(static_cast<int64_t>(pixels.size()), kPixels, [&](int64_t begin, int64_t end) {
    const auto tracer = std::make_unique<PixelTracer>(bvh, lights, camera, width, height, options);
    const auto first = static_cast<size_t>(begin), count = static_cast<size_t>(end - begin);
    tracer->trace(pixels.subspan(first, count), std::span(out).subspan(first, count));
    if (done) done(end - begin);
  });
  return out;
}

}  // namespace lte::pathtrace
