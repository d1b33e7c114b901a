#include "tests/bench/gather_reference.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <span>
#include <string>

#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/parallel.h"
#include "lte/pathtrace/gbuffer.h"
#include "lte/pathtrace/placement/auto_camera.h"
#include "lte/pathtrace/transport/irradiance_kernel.h"
#include "lte/pathtrace/transport/transport.h"

namespace lte::bench {
namespace {

constexpr double kEpsilon = 1e-2;

/// Traces one half: depths 2 to 5, and 2 to 6, of the same paths.
class HalfTracer : public pathtrace::LightSink {
 public:
  void add(int depth, std::span<const pathtrace::Contribution> contributions) override {
    if (depth == 1) return;
    for (const pathtrace::Contribution& c : contributions) {
      for (int k = 0; k < 3; ++k) {
        if (depth <= kModelDepth) sums[0][k] += double{c.value[k]};
        sums[1][k] += double{c.value[k]};
      }
    }
  }
  double sums[2][3] = {};
};

void trace_half(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                std::span<const Vec3> positions, std::span<const Vec3> normals, uint64_t seed,
                std::vector<Rgb>* depth5, std::vector<Rgb>* depth6) {
  depth5->resize(positions.size());
  depth6->resize(positions.size());
  const float half_extent = 0.5f * max_component(bvh.bounds().extent());
  parallel_for(static_cast<int64_t>(positions.size()), 16, [&](int64_t begin, int64_t end) {
    HalfTracer sink;
    const auto sampler =
        std::make_unique<pathtrace::PathSampler>(pathtrace::Sampling::Sobol, kHalfPaths);
    const auto transport =
        std::make_unique<pathtrace::Transport>(bvh, lights, kModelDepth + 1, 3, sink);
    for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i) {
      const Vec3 origin =
          pathtrace::offset_origin(positions[i], normals[i], half_extent) - bvh.handles().origin;
      std::memset(sink.sums, 0, sizeof(sink.sums));
      sampler->start_stream(seed, i);
      sampler->start_set();
      for (int k = 0; k < kHalfPaths; ++k) {
        const int lane = sampler->paths();
        transport->start().origin.put(lane, origin);
        transport->start().normal.put(lane, normals[i]);
        sampler->add_path();
        if (sampler->paths() < pathtrace::kBlock && k + 1 < kHalfPaths) continue;
        transport->trace_indirect(*sampler);
        sampler->clear();
      }
      for (int c = 0; c < 3; ++c) {
        const double scale = double{kPi} / kHalfPaths;
        (*depth5)[i][c] = static_cast<float>(sink.sums[0][c] * scale);
        (*depth6)[i][c] = static_cast<float>(sink.sums[1][c] * scale);
      }
    }
  });
}

}  // namespace

View look(const pathtrace::Bvh& bvh, int width, int height) {
  const scene::Scene& scene = bvh.scene();
  const scene::Camera camera =
      scene.cameras.empty() ? pathtrace::auto_camera(bvh) : scene.cameras.front();
  const pathtrace::GBuffer seen = pathtrace::trace_gbuffer(bvh, camera, width, height);
  View view;
  for (size_t i = 0; i < seen.mask.size(); ++i) {
    if (!seen.mask[i] || max_component(seen.albedo[i]) <= 0) continue;
    view.position.push_back(seen.position[i]);
    view.normal.push_back(seen.normal[i]);
    view.albedo.push_back(seen.albedo[i]);
    const float cosine =
        std::fabs(dot(normalize(camera.origin - seen.position[i]), seen.normal[i]));
    view.spacing.push_back(pathtrace::pixel_size(camera, height) * seen.depth[i] /
                           std::sqrt(std::max(cosine, 0.05f)));
  }
  LTE_CHECK(!view.position.empty(), "the camera sees no reflecting surface");
  return view;
}

Reference reference_of(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights, const View& view,
                       const std::filesystem::path& cached) {
  Reference out;
  const size_t count = view.position.size(), bytes = count * sizeof(Rgb);
  if (std::filesystem::exists(cached) && std::filesystem::file_size(cached) == 4 * bytes) {
    const std::string data = read_file(cached);
    for (size_t k = 0; k < 4; ++k) {
      out.half[k / 2][k % 2].resize(count);
      std::memcpy(out.half[k / 2][k % 2].data(), data.data() + k * bytes, bytes);
    }
    return out;
  }
  std::string data;
  for (auto& half : out.half) {
    const uint64_t seed = &half == out.half ? 101 : 202;
    trace_half(bvh, lights, view.position, view.normal, seed, &half[0], &half[1]);
    for (const std::vector<Rgb>& values : half)
      data.append(reinterpret_cast<const char*>(values.data()), bytes);
  }
  std::filesystem::create_directories(cached.parent_path());
  write_file(cached, data);
  return out;
}

Score score(const std::vector<Rgb>& values, const Reference& reference, bool one_more) {
  const std::vector<Rgb>&a = reference.half[0][one_more], &b = reference.half[1][one_more];
  Score out;
  for (size_t i = 0; i < values.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      const double error =
          (double{values[i][c]} - double{a[i][c]}) * (double{values[i][c]} - double{b[i][c]});
      const double mean = 0.5 * (double{a[i][c]} + double{b[i][c]});
      out.mse += error;
      out.relmse += error / (mean * mean + kEpsilon);
    }
  }
  const auto count = 3 * static_cast<double>(values.size());
  return {out.mse / count, out.relmse / count};
}

Score score_against_second(const std::vector<Rgb>& values, const Reference& reference) {
  const std::vector<Rgb>&a = reference.half[0][0], &b = reference.half[1][0];
  Score out;
  for (size_t i = 0; i < values.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      const double miss = double{values[i][c]} - double{b[i][c]};
      const double noise = double{a[i][c]} - double{b[i][c]};
      const double mean = 0.5 * (double{a[i][c]} + double{b[i][c]});
      const double error = miss * miss - 0.5 * noise * noise;
      out.mse += error;
      out.relmse += error / (mean * mean + kEpsilon);
    }
  }
  const auto count = 3 * static_cast<double>(values.size());
  return {out.mse / count, out.relmse / count};
}

}  // namespace lte::bench
