#include "experiments/consistency/consistency.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "infer/picture/projection.h"
#include "infer/picture/surface_guides.h"
#include "infer/renderer/quality.h"
#include "lte/base/check.h"
#include "lte/pathtrace/placement/turntable.h"
#include "lte/pathtrace/ray_offset.h"

namespace lte::experiments {

using namespace infer;

namespace {

using image::Image;

/// Of the frames whose points are queries again, and of the pixels of such a frame.
constexpr size_t kPointFrames = 4;
constexpr size_t kPointStep = 13;
constexpr int kShadowRays = 64;  // of pictures by the network

/// Points of surfaces that a frame sees at the centres of its pixels.
struct Points {
  std::vector<Vec3> position, normal;
  std::vector<Rgb> albedo;

  void append(const Points& from, size_t i) {
    position.push_back(from.position[i]);
    normal.push_back(from.normal[i]);
    albedo.push_back(from.albedo[i]);
  }
};

Points points_seen(const pathtrace::Bvh& bvh, const scene::Camera& camera,
                   const ConsistencyOptions& options) {
  const SurfaceGuides guides = trace_guides(bvh, camera, options.width, options.height);
  Points out;
  for (int y = 0; y < guides.height(); ++y) {
    for (int x = 0; x < guides.width(); ++x) {
      if (!guides.mask[guides.index(x, y)]) continue;
      out.position.push_back(guides.position.rgb(x, y));
      out.normal.push_back(guides.normal.rgb(x, y));
      out.albedo.push_back(guides.albedo.rgb(x, y));
    }
  }
  return out;
}

/// Some points of frames along the way.
Points points_to_repeat(const pathtrace::Bvh& bvh, std::span<const scene::Camera> cameras,
                        const ConsistencyOptions& options) {
  Points out;
  const size_t frames = std::min(kPointFrames, cameras.size());
  for (size_t f = 0; f < frames; ++f) {
    const Points seen = points_seen(bvh, cameras[f * cameras.size() / frames], options);
    for (size_t i = 0; i < seen.position.size(); i += kPointStep) out.append(seen, i);
  }
  return out;
}

bool is_seen(const pathtrace::Bvh& bvh, const scene::Camera& camera, const Projection& projection,
             const Vec3& position, const Vec3& normal, const ConsistencyOptions& options) {
  const Vec3 way = camera.origin - position;
  const auto place = projection.place(position);
  if (dot(way, normal) <= 0 || !place) return false;
  if (!(place->x >= 0 && place->x <= static_cast<float>(options.width) && place->y >= 0 &&
        place->y <= static_cast<float>(options.height)))
    return false;
  return !bvh.occluded({pathtrace::offset_origin(position, normal), way, 0, 1});
}

/// Queries the network in each frame at the points of its pixels and, in the same call, at the
/// repeated points.
void repeat_answers(const Renderer& renderer, std::span<const scene::Camera> cameras,
                    const ConsistencyOptions& options, Consistency* out) {
  const pathtrace::Bvh& bvh = renderer.bvh();
  const Points fixed = points_to_repeat(bvh, cameras, options);
  RepeatedAnswers repeated(fixed.position.size());
  for (const scene::Camera& camera : cameras) {
    const Projection projection(camera, options.width, options.height);
    Points queries = points_seen(bvh, camera, options);
    const size_t first = queries.position.size();
    std::vector<size_t> numbers;
    for (size_t i = 0; i < fixed.position.size(); ++i) {
      if (!is_seen(bvh, camera, projection, fixed.position[i], fixed.normal[i], options)) continue;
      queries.append(fixed, i);
      numbers.push_back(i);
    }
    const std::vector<Rgb> answers =
        renderer.embedding().decode({queries.position, queries.normal, queries.albedo});
    repeated.add(numbers, std::span(answers).subspan(first));
  }
  out->points = static_cast<int64_t>(fixed.position.size());
  out->answers = repeated.compared();
  out->largest_change = repeated.largest_change();
}

struct Method {
  std::string name;
  RenderSettings settings;
};

std::vector<Method> methods_of(const ConsistencyOptions& options) {
  RenderSettings base;
  base.width = options.width;
  base.height = options.height;
  base.edge_rays = 0;
  base.passes = 1;
  base.denoise = false;
  base.max_depth = options.max_depth;
  Method network{concat("gathered from the network, ", kShadowRays, " rays and light samples"),
                 base};
  network.settings.method = render::Method::Network;
  network.settings.gather_rays = network.settings.light_samples = kShadowRays;
  Method paths{concat(options.spp, " paths a pixel"), with_paths(options.spp, base)};
  paths.settings.method = render::Method::Path;
  Method denoised{concat(options.spp, " paths a pixel, denoised"), paths.settings};
  denoised.settings.denoise = true;
  return {network, paths, denoised};
}

Image sum(Image a, const Image& b) {
  std::transform(a.pixels.begin(), a.pixels.end(), b.pixels.begin(), a.pixels.begin(),
                 std::plus<>());
  return a;
}

ConsistencyRow measure(const Method& method, std::span<const scene::Camera> cameras, uint64_t seed,
                       Renderer* renderer, std::string* denoiser) {
  std::vector<FlickerFrame> indirect, total;
  if (renderer->needs_cache(method.settings)) renderer->make_cache(method.settings.method, {});
  RenderSettings settings = method.settings;
  for (const scene::Camera& camera : cameras) {
    settings.seed = seed++;
    Frame frame = renderer->render(camera, settings);
    if (!renderer->denoised_by().empty()) *denoiser = renderer->denoised_by();
    total.push_back({camera, sum(frame.indirect, frame.direct), frame.depth});
    indirect.push_back({camera, std::move(frame.indirect), std::move(frame.depth)});
  }
  return {method.name, measure_flicker(indirect), measure_flicker(total)};
}

}  // namespace

void RepeatedAnswers::add(std::span<const size_t> points, std::span<const Rgb> answers) {
  LTE_CHECK(points.size() == answers.size(), "expected an answer a point, got ", answers.size(),
            " for ", points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    const size_t point = points[i];
    if (!known_.at(point)) {
      known_[point] = 1;
      first_[point] = answers[i];
      continue;
    }
    ++compared_;
    for (int c = 0; c < 3; ++c) {
      const double change = std::abs(double{answers[i][c]} - double{first_[point][c]});
      if (change > largest_ || std::isnan(change)) largest_ = change;  // and NaN stays
    }
  }
}

std::vector<scene::Camera> consistency_cameras(const pathtrace::Bvh& bvh,
                                               const scene::Camera& first,
                                               const ConsistencyOptions& options) {
  const auto turn = static_cast<int>(std::lround(options.frames * 360 / options.degrees));
  std::vector<scene::Camera> cameras =
      pathtrace::turntable(bvh, first, std::max(turn, options.frames)).cameras;
  cameras.resize(static_cast<size_t>(options.frames));
  return cameras;
}

Consistency measure_consistency(Renderer* renderer, std::span<const scene::Camera> cameras,
                                const ConsistencyOptions& options) {
  Consistency out;
  repeat_answers(*renderer, cameras, options, &out);
  for (const Method& method : methods_of(options))
    out.rows.push_back(measure(method, cameras, options.seed, renderer, &out.denoiser));
  return out;
}

}  // namespace lte::experiments
