#include "lte/bake/light.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "lte/bake/sides.h"
#include "lte/bake/texel_sampler.h"
#include "lte/base/check.h"
#include "lte/base/timer.h"

namespace lte::bake {
namespace {

constexpr uint64_t kRays = 82, kPathRays = 84;
/// What all samples share, relative, beyond what halves disagree by (lte_probe has found it).
constexpr double kSharedError = 0.015;
/// Seconds that smoothing takes a texel and kind of light, about.
constexpr double kSmoothingSeconds = 6e-6;
/// Steps of progress beside passes: sides, darkness, neighbours, means.
constexpr int kOtherSteps = 4;
/// Rays of a texel in a pass of paths.
constexpr int kPathsAPass = 2;
/// Passes after which the error is looked at for the first time, and whenever they have doubled.
constexpr int kFirstLook = 8;

/// One bake of light, from the first pass to the last.
class Bake {
 public:
  Bake(const render::TracedScene& scene, const render::Integrator& integrator, const Atlas& atlas,
       const Texels& texels, const LightOptions& options)
      : scene_(scene),
        integrator_(integrator),
        atlas_(atlas),
        texels_(texels),
        options_(options),
        sampler_(atlas, texels, options),
        samples_(texels.size(), options.direct),
        lit_(texels.size()) {
    out_.irradiance.resize(texels.size());
    out_.dark.resize(texels.size());
    out_.back.resize(static_cast<size_t>(atlas.charts));
    std::iota(lit_.begin(), lit_.end(), 0u);
  }

  TexelLight run() {
    const std::vector<Vec3> normals = find_sides();
    const TexelGraph graph(scene_.bvh, {texels_.position, normals, texels_.edge, out_.dark});
    done();
    gather(graph);
    Halves light = smooth(graph, samples_.means(samples_.indirect));
    if (!traces_alone() && options_.path_passes > 0) light = corrected(graph, std::move(light));
    if (options_.direct) {
      const Halves direct = smooth(graph, samples_.means(samples_.direct));
      for (size_t h = 0; h < 2; ++h)
        for (size_t i = 0; i < direct[h].size(); ++i) light[h][i] += direct[h][i];
    }
    out_.expected_error = std::hypot(relative_error(light), traces_alone() ? 0 : kSharedError);
    for (const uint32_t i : lit_) out_.irradiance[i] = (light[0][i] + light[1][i]) * 0.5f;
    done();
    return std::move(out_);
  }

 private:
  bool traces_alone() const { return integrator_.method() == render::Method::Path; }

  void done() {
    ++step_;
    if (!options_.progress) return;
    const double steps = options_.passes + options_.path_passes + kOtherSteps;
    options_.progress(std::min(1.0, std::max(timer_.seconds() / options_.seconds, step_ / steps)));
  }

  void pass(const TexelSampler& sampler, const render::Integrator& by, uint64_t stream, int number,
            TexelSamples* into) {
    const Timer timer;
    sampler.pass(by, lit_, out_.back, sampler.sampling(stream), number, into);
    last_pass_s_ = timer.seconds();
    done();
  }

  /// Whether two passes more, and what comes after them, end in time.
  bool two_fit() const {
    const double smoothing =
        kSmoothingSeconds * static_cast<double>(texels_.size()) * (options_.direct ? 2 : 1);
    return timer_.seconds() + 2 * last_pass_s_ + smoothing <= options_.seconds;
  }

  /// Two passes, and what they say of sides and of darkness. Leaves lit texels in `lit_`.
  /// @return  normals of the sides that are baked
  std::vector<Vec3> find_sides() {
    if (options_.back != nullptr) out_.back = *options_.back;
    for (int k = 0; k < 2; ++k) pass(sampler_, integrator_, kRays, k, &samples_);
    if (options_.back == nullptr)
      choose_sides(sampler_, integrator_, atlas_, texels_, &samples_, &out_);
    done();
    std::vector<Vec3> normals = turned_normals(texels_, out_.back);
    find_darkness(scene_.bvh, atlas_, texels_, samples_, normals, options_, &out_);
    std::erase_if(lit_, [&](uint32_t i) { return out_.dark[i] != 0; });
    done();
    return normals;
  }

  /// Whether light is known well enough, which is looked at when samples have doubled.
  template <typename Estimate>
  bool is_even(int passes, int* next_look, const Estimate& estimate) const {
    if (options_.error <= 0 || passes < *next_look) return false;
    *next_look *= 2;
    return relative_error(estimate()) <= options_.error;
  }

  /// The other passes by the integrator.
  void gather(const TexelGraph& graph) {
    int next_look = kFirstLook;
    for (int k = 2; k < options_.passes && two_fit(); k += 2) {
      if (is_even(k, &next_look, [&] { return smooth(graph, samples_.means(samples_.indirect)); }))
        break;
      for (int h = 0; h < 2; ++h) pass(sampler_, integrator_, kRays, k + h, &samples_);
    }
    out_.passes = samples_.passes[0] + samples_.passes[1];
    if (traces_alone()) out_.paths = out_.passes * options_.rays;
  }

  /// Gathered light drawn towards what paths find.
  Halves corrected(const TexelGraph& graph, Halves gathered) {
    const auto paths = render::make_path(scene_, options_.max_depth);
    LightOptions thin = options_;
    thin.rays = kPathsAPass;
    thin.direct = false;
    const TexelSampler sampler(atlas_, texels_, thin);
    TexelSamples traced(texels_.size(), false);
    int next_look = kFirstLook;
    for (int k = 0; k < options_.path_passes && two_fit(); k += 2) {
      if (is_even(k, &next_look,
                  [&] { return correct(graph, gathered, traced.means(traced.indirect)); }))
        break;
      for (int h = 0; h < 2; ++h) pass(sampler, *paths, kPathRays, k + h, &traced);
    }
    out_.paths = kPathsAPass * (traced.passes[0] + traced.passes[1]);
    if (out_.paths == 0) return gathered;
    return correct(graph, std::move(gathered), traced.means(traced.indirect));
  }

  const render::TracedScene& scene_;
  const render::Integrator& integrator_;
  const Atlas& atlas_;
  const Texels& texels_;
  const LightOptions& options_;
  const Timer timer_;
  TexelSampler sampler_;
  TexelSamples samples_;
  std::vector<uint32_t> lit_;  ///< texels that passes are over: all, then those that are not dark
  TexelLight out_;
  int step_ = 0;
  double last_pass_s_ = 0;
};

}  // namespace

std::vector<Vec3> turned_normals(const Texels& texels, const std::vector<uint8_t>& back) {
  std::vector<Vec3> out = texels.normal;
  for (size_t i = 0; i < out.size(); ++i)
    if (back[static_cast<size_t>(texels.chart[i])] != 0) out[i] = -out[i];
  return out;
}

std::vector<Rgb> trace_texels(const render::TracedScene& scene, const Atlas& atlas,
                              const Texels& texels, const std::vector<uint8_t>& back,
                              std::span<const uint32_t> which, const LightOptions& options) {
  const auto paths = render::make_path(scene, options.max_depth);
  const TexelSampler sampler(atlas, texels, options);
  TexelSamples samples(texels.size(), false);
  render::PointSampling sampling = sampler.sampling(kPathRays);
  sampling.light_samples = 0;
  for (int k = 0; k < options.passes; ++k) sampler.pass(*paths, which, back, sampling, k, &samples);
  std::vector<Rgb> out;
  for (const uint32_t i : which)
    out.push_back((samples.indirect[0][i] + samples.indirect[1][i]) /
                  static_cast<float>(options.passes));
  return out;
}

TexelLight light_texels(const render::TracedScene& scene, const render::Integrator& integrator,
                        const Atlas& atlas, const Texels& texels, const LightOptions& options) {
  LTE_CHECK(options.passes >= 2 && options.rays >= 1 && options.path_passes >= 0,
            "light of texels: expected two passes of a ray at least");
  return Bake(scene, integrator, atlas, texels, options).run();
}

}  // namespace lte::bake
