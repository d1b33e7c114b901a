#include "lte/bake/light.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numeric>
#include <optional>
#include <utility>

#include "lte/bake/atlas_denoiser.h"
#include "lte/bake/rates.h"
#include "lte/bake/sides.h"
#include "lte/bake/texel_sampler.h"
#include "lte/base/check.h"
#include "lte/base/timer.h"
#include "lte/gi/expected_error.h"

namespace lte::bake {
namespace {

constexpr uint64_t kRays = 82, kPathRays = 84;
/// Seconds that smoothing takes a texel and kind of light, about, by a denoiser where there is one.
constexpr double kSmoothingSeconds = 1e-5;
/// Rays of texels for each path of all records.
constexpr double kRaysARecordPath = 4;
/// The least and most records, and their paths above which there are more of them.
constexpr int64_t kLeastRecords = 4 * render::CacheSettings{}.records;
constexpr int64_t kMostRecords = 4 * kLeastRecords;
constexpr double kEnoughRecordPaths = 64;
/// The least and most paths of a record, of 2.
constexpr int kLeastRecordPaths = 4, kMostRecordPaths = 8;
/// Steps of progress beside passes: sides, darkness, neighbours, means.
constexpr int kOtherSteps = 4;
/// Passes after which the error is looked at for the first time, and whenever they have doubled.
constexpr int kFirstLook = 8;

/// The graph of a state, which has it afterwards.
const TexelGraph& graph_of(const pathtrace::Bvh& bvh, const Texels& texels, LightState* state) {
  if (!state->graph) {
    const std::vector<Vec3> normals = turned_normals(texels, state->back);
    state->graph = std::make_shared<const TexelGraph>(
        bvh, GraphPlaces{texels.position, normals, texels.edge, state->dark});
  }
  return *state->graph;
}

/// The texels that light reaches.
std::vector<uint32_t> lit_texels(const LightState& state) {
  std::vector<uint32_t> out(state.dark.size());
  std::iota(out.begin(), out.end(), 0u);
  std::erase_if(out, [&](uint32_t i) { return state.dark[i] != 0; });
  return out;
}

/// Of the passes after the first two, those that a lit texel takes part in.
double mean_rate(const LightState& state) {
  double sum = 0, lit = 0;
  for (size_t i = 0; i < state.dark.size(); ++i) {
    if (state.dark[i] != 0) continue;
    sum += static_cast<double>(state.rate[i]) / kFullRate;
    ++lit;
  }
  return lit > 0 ? std::max(sum / lit, 1.0 / kFullRate) : 1;
}

/// Mean over lit texels.
double mean_passes(const LightState& state, const TexelSamples& samples) {
  const double all = samples.passes[0] + samples.passes[1];
  return all <= 2 ? all : 2 + (all - 2) * mean_rate(state);
}

/// Two halves of indirect light.
Halves indirect_of(const TexelGraph& graph, const LightState& state, const Denoise& denoise) {
  Halves out = smooth(graph, state.samples.means(state.samples.indirect, state.rate), denoise);
  if (state.paths.passes[0] == 0) return out;
  return correct(graph, std::move(out), state.paths.means(state.paths.indirect, state.rate),
                 denoise);
}

Denoise denoise_by(const std::optional<AtlasDenoiser>& denoiser) {
  if (!denoiser) return {};
  return std::cref(*denoiser);
}

/// The passes of a bake, from the first to the last.
class Bake {
 public:
  Bake(const render::TracedScene& scene, const render::Integrator& integrator, const Atlas& atlas,
       const Texels& texels, const LightOptions& options)
      : scene_(scene),
        integrator_(integrator),
        atlas_(atlas),
        texels_(texels),
        options_(options),
        sampler_(atlas, texels, options) {}

  LightState run() {
    if (options_.from != nullptr) {
      state_ = *options_.from;
    } else {
      start();
    }
    lit_ = lit_texels(state_);
    mean_rate_ = mean_rate(state_);
    sample(sampler_, integrator_, kRays, options_.passes, &state_.samples);
    if (integrator_.method() != render::Method::Path) {
      LightOptions thin = options_;
      thin.rays = kPathsAPass;
      thin.direct = false;
      const auto paths = render::make_path(scene_, options_.max_depth);
      sample(TexelSampler(atlas_, texels_, thin), *paths, kPathRays, options_.path_passes,
             &state_.paths);
    }
    return std::move(state_);
  }

 private:
  void done() {
    ++step_;
    if (!options_.progress) return;
    const int steps = passes_for(options_.passes) + passes_for(options_.path_passes) + kOtherSteps;
    // Rates, once they are known, make the steps more.
    share_ = std::max(share_, std::min(1.0, std::max(timer_.seconds() / options_.seconds,
                                                     static_cast<double>(step_) / steps)));
    options_.progress(share_);
  }

  /// Passes after which texels have had `count` in the mean.
  int passes_for(int count) const {
    return count <= 2 ? count : 2 + 2 * static_cast<int>(std::ceil((count - 2) / mean_rate_ / 2));
  }

  void pass(const TexelSampler& sampler, const render::Integrator& by, uint64_t stream, int number,
            Shard shard, TexelSamples* into) {
    const Timer timer;
    sampler.pass(by, lit_, state_.back, sampler.sampling(stream), number, into, state_.rate, shard);
    last_pass_s_ = timer.seconds();
    done();
  }

  /// Whether two passes more, and what comes after them, end in time.
  bool two_fit() const {
    const double smoothing =
        kSmoothingSeconds * static_cast<double>(texels_.size()) * (options_.direct ? 2 : 1);
    return timer_.seconds() + 2 * last_pass_s_ + smoothing <= options_.seconds;
  }

  void take(Sides sides) {
    state_.back = std::move(sides.back);
    state_.two_sided = sides.two_sided;
  }

  /// Two passes, and what they say of sides and of darkness.
  void start() {
    state_.samples = TexelSamples(texels_.size(), options_.direct);
    state_.paths = TexelSamples(texels_.size(), false);
    state_.dark.resize(texels_.size());
    state_.back.resize(static_cast<size_t>(atlas_.charts));
    lit_ = lit_texels(state_);
    if (options_.sides != nullptr) take(*options_.sides);
    state_.rate.assign(texels_.size(), kFullRate);
    for (int k = 0; k < 2; ++k) pass(sampler_, integrator_, kRays, k, {}, &state_.samples);
    if (options_.sides == nullptr) {
      take(choose_sides(sampler_, integrator_, atlas_, texels_, lit_, state_.samples));
      sample_turned(sampler_, integrator_, texels_, state_.back, &state_.samples);
    }
    done();
    find_darkness(scene_.bvh, atlas_, texels_, options_, &state_);
    done();
    state_.rate =
        sampling_rates(graph_of(scene_.bvh, texels_, &state_),
                       state_.samples.means(state_.samples.indirect, state_.rate), state_.dark);
    done();
    if (options_.keep) options_.keep(state_);
  }

  /// Whether light is known well enough.
  bool is_even() {
    const TexelGraph& graph = graph_of(scene_.bvh, texels_, &state_);
    const auto denoiser = AtlasDenoiser::find(atlas_, texels_, state_.dark);
    return relative_error(indirect_of(graph, state_, denoise_by(denoiser))) <= options_.error;
  }

  /// Passes two by two, until texels have had `count` in the mean. The error is looked at when
  /// samples have doubled.
  void sample(const TexelSampler& sampler, const render::Integrator& by, uint64_t stream, int count,
              TexelSamples* into) {
    int next_look = kFirstLook;
    const int end = passes_for(count);
    for (int k = into->passes[0] + into->passes[1]; k < end && two_fit(); k += 2) {
      if (options_.error > 0 && k >= next_look) {
        next_look *= 2;
        if (is_even()) return;
      }
      for (int h = 0; h < 2; ++h) pass(sampler, by, stream, k + h, options_.shard, into);
      if (options_.keep) options_.keep(state_);
    }
  }

  const render::TracedScene& scene_;
  const render::Integrator& integrator_;
  const Atlas& atlas_;
  const Texels& texels_;
  const LightOptions& options_;
  const Timer timer_;
  TexelSampler sampler_;
  LightState state_;
  std::vector<uint32_t> lit_;  ///< texels that passes are over: all, then those that are not dark
  int step_ = 0;
  double share_ = 0;  ///< of the work, as progress was last given
  double mean_rate_ = 1;
  double last_pass_s_ = 0;
};

double paths_of_records(double texels, const LightOptions& options) {
  return texels * options.rays * options.passes / kRaysARecordPath;
}

void take(const TexelSamples& from, uint32_t texel, TexelSamples* to) {
  for (size_t h = 0; h < 2; ++h) {
    if (!to->indirect[h].empty()) to->indirect[h][texel] = from.indirect[h][texel];
    if (!to->direct[h].empty()) to->direct[h][texel] = from.direct[h][texel];
  }
}

}  // namespace

int64_t record_count(double texels, const LightOptions& options) {
  const double records = paths_of_records(texels, options) / kEnoughRecordPaths;
  return std::clamp(static_cast<int64_t>(std::min(records, 1e9)), kLeastRecords, kMostRecords);
}

int record_paths(double texels, int64_t records, const LightOptions& options) {
  const double paths =
      std::max(1.0, paths_of_records(texels, options) / static_cast<double>(records));
  return 1 << std::clamp(static_cast<int>(std::lround(std::log2(paths))), kLeastRecordPaths,
                         kMostRecordPaths);
}

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
  LightOptions indirect = options;
  indirect.direct = false;
  const TexelSampler sampler(atlas, texels, indirect);
  TexelSamples samples(texels.size(), false);
  for (int k = 0; k < options.passes; ++k)
    sampler.pass(*paths, which, back, sampler.sampling(kPathRays), k, &samples);
  std::vector<Rgb> out;
  for (const uint32_t i : which)
    out.push_back((samples.indirect[0][i] + samples.indirect[1][i]) /
                  static_cast<float>(options.passes));
  return out;
}

Sides find_sides(const render::Integrator& integrator, const Atlas& atlas, const Texels& texels,
                 const LightOptions& options) {
  const TexelSampler sampler(atlas, texels, options);
  const std::vector<uint32_t> which = deciding_texels(texels, atlas.charts);
  const std::vector<uint8_t> front(static_cast<size_t>(atlas.charts));
  TexelSamples samples(texels.size(), options.direct);
  for (int k = 0; k < 2; ++k)
    sampler.pass(integrator, which, front, sampler.sampling(kRays), k, &samples);
  return choose_sides(sampler, integrator, atlas, texels, which, samples);
}

LightState sample_texels(const render::TracedScene& scene, const render::Integrator& integrator,
                         const Atlas& atlas, const Texels& texels, const LightOptions& options) {
  LTE_CHECK(options.passes >= 2 && options.rays >= 1 && options.path_passes >= 0,
            "light of texels: expected two passes of a ray at least");
  const Shard& shard = options.shard;
  LTE_CHECK(shard.count >= 1 && shard.number >= 0 && shard.number < shard.count,
            "light of texels: there is no shard ", shard.number, " of ", shard.count);
  LTE_CHECK(shard.count == 1 || (std::isinf(options.seconds) && options.error <= 0),
            "light of texels: shards have passes of a given number");
  return Bake(scene, integrator, atlas, texels, options).run();
}

LightState joined(const std::vector<LightState>& shards) {
  LTE_CHECK(!shards.empty(), "light of texels: no shard to join");
  LightState out = shards.front();
  for (const LightState& one : shards) {
    LTE_CHECK(one.dark == out.dark && one.back == out.back && one.rate == out.rate &&
                  one.samples.passes == out.samples.passes && one.paths.passes == out.paths.passes,
              "light of texels: shards of different bakes");
  }
  const std::vector<uint32_t> lit = lit_texels(out);
  const auto count = static_cast<int>(shards.size());
  for (int k = 1; k < count; ++k) {
    const LightState& from = shards[static_cast<size_t>(k)];
    for (size_t place = 0; place < lit.size(); ++place) {
      if (!Shard{k, count}.has(place)) continue;
      take(from.samples, lit[place], &out.samples);
      take(from.paths, lit[place], &out.paths);
    }
  }
  return out;
}

TexelLight light_of(const pathtrace::Bvh& bvh, render::Method method, const Atlas& atlas,
                    const Texels& texels, const LightOptions& options, LightState state) {
  const TexelGraph& graph = graph_of(bvh, texels, &state);
  const auto denoiser = AtlasDenoiser::find(atlas, texels, state.dark);
  const Denoise denoise = denoise_by(denoiser);
  const bool by_paths = method == render::Method::Path;
  TexelLight out;
  out.irradiance.resize(texels.size());
  out.two_sided = state.two_sided;
  out.passes = mean_passes(state, state.samples);
  out.paths = by_paths ? out.passes * options.rays : kPathsAPass * mean_passes(state, state.paths);
  if (denoiser) out.denoiser = denoiser->name();
  Halves light = indirect_of(graph, state, denoise);
  if (options.direct) {
    const Halves direct =
        smooth(graph, state.samples.means(state.samples.direct, state.rate), denoise);
    for (size_t h = 0; h < 2; ++h)
      for (size_t i = 0; i < direct[h].size(); ++i) light[h][i] += direct[h][i];
  }
  out.expected_error = std::hypot(relative_error(light), by_paths ? 0 : gi::kSharedError);
  for (const uint32_t i : lit_texels(state)) out.irradiance[i] = (light[0][i] + light[1][i]) * 0.5f;
  out.dark = std::move(state.dark);
  out.back = std::move(state.back);
  if (options.progress) options.progress(1);
  return out;
}

TexelLight light_texels(const render::TracedScene& scene, const render::Integrator& integrator,
                        const Atlas& atlas, const Texels& texels, const LightOptions& options) {
  return light_of(scene.bvh, integrator.method(), atlas, texels, options,
                  sample_texels(scene, integrator, atlas, texels, options));
}

}  // namespace lte::bake
