#include "lte/bake/light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/base/random.h"
#include "lte/base/timer.h"
#include "lte/pathtrace/reach/reach.h"

namespace lte::bake {
namespace {

constexpr size_t kBlock = 1 << 14;  // texels between two looks at the clock
/// A chart faces the side that more than this share of its texels find light on.
constexpr double kLitShare = 0.02;
/// Of the mean light: what is darker is looked at again, by paths that end where light is.
constexpr float kDim = 0.03f;
constexpr uint64_t kPlaces = 81, kRays = 82, kBackRays = 83, kPathRays = 84, kReachPaths = 85;
/// What all samples share, relative, beyond what halves disagree by (lte_probe has found it).
constexpr double kSharedError = 0.015;

/// Sums of samples of one kind of light.
struct Samples {
  std::array<std::vector<Rgb>, 2> direct, indirect;
  std::array<int, 2> passes{};

  explicit Samples(size_t count, bool with_direct) {
    for (size_t h = 0; h < 2; ++h) {
      indirect[h].resize(count);
      if (with_direct) direct[h].resize(count);
    }
  }
  Halves means(const std::array<std::vector<Rgb>, 2>& sums) const {
    Halves out = sums;
    for (size_t h = 0; h < 2; ++h)
      for (Rgb& value : out[h]) value *= 1.0f / static_cast<float>(std::max(1, passes[h]));
    return out;
  }
};

class Baker {
 public:
  Baker(const render::TracedScene& scene, const Atlas& atlas, const Texels& texels,
        const LightOptions& options)
      : scene_(scene), atlas_(atlas), texels_(texels), options_(options) {}

  /// A pass over some texels, whose numbers ascend.
  void pass(const render::Integrator& integrator, std::span<const uint32_t> which,
            std::span<const uint8_t> back, const render::PointSampling& sampling, int number,
            Samples* samples) const {
    const auto half = static_cast<size_t>(number) % 2;
    render::PointSampling one = sampling;
    one.seed =
        hash_combine(hash_combine(options_.seed, sampling.seed), static_cast<uint64_t>(number));
    for (size_t begin = 0; begin < which.size(); begin += kBlock) {
      const auto block = which.subspan(begin, std::min(kBlock, which.size() - begin));
      std::vector<Vec3> position(block.size()), normal(block.size());
      parallel_for(static_cast<int64_t>(block.size()), 512, [&](int64_t first, int64_t end) {
        for (auto i = static_cast<size_t>(first); i < static_cast<size_t>(end); ++i) {
          const TexelPlace place = place_in(atlas_, texels_, block[i], numbers(block[i], number));
          position[i] = place.position;
          const auto chart = static_cast<size_t>(texels_.chart[block[i]]);
          normal[i] = back[chart] != 0 ? -place.normal : place.normal;
        }
      });
      one.first_index = static_cast<int64_t>(begin);
      const render::PointIrradiance found = integrator.irradiance({position, normal}, one);
      for (size_t i = 0; i < block.size(); ++i) {
        samples->indirect[half][block[i]] += found.indirect[i];
        if (!found.direct.empty()) samples->direct[half][block[i]] += found.direct[i];
      }
    }
    ++samples->passes[half];
  }

  render::PointSampling sampling(uint64_t stream) const {
    render::PointSampling out;
    out.rays = options_.rays;
    out.light_samples = options_.direct ? options_.light_samples : 0;
    out.seed = stream;
    return out;
  }

 private:
  /// Places of a texel over the passes: the golden ratio's sequence, from a start of its own.
  std::array<float, 3> numbers(uint32_t texel, int number) const {
    Rng rng(hash_combine(options_.seed, kPlaces), texels_.pixel[texel]);
    constexpr std::array<double, 3> kSteps = {0.8191725134, 0.6710436067, 0.5497004779};
    std::array<float, 3> out;
    for (size_t k = 0; k < 3; ++k) {
      const double at = double{rng.uniform()} + kSteps[k] * number;
      out[k] = std::min(static_cast<float>(at - std::floor(at)), 1 - 0x1p-24f);
    }
    return out;
  }

  const render::TracedScene scene_;
  const Atlas& atlas_;
  const Texels& texels_;
  const LightOptions& options_;
};

Rgb sum_of(const Samples& samples, size_t i) {
  Rgb sum = samples.indirect[0][i] + samples.indirect[1][i];
  if (!samples.direct[0].empty()) sum += samples.direct[0][i] + samples.direct[1][i];
  return sum;
}

/// What a side of each chart has shown of light.
struct ChartLight {
  std::vector<double> light;
  std::vector<int64_t> texels, lit;

  ChartLight(const Texels& t, const Samples& samples, std::span<const uint32_t> which,
             int32_t count)
      : light(static_cast<size_t>(count)),
        texels(static_cast<size_t>(count)),
        lit(static_cast<size_t>(count)) {
    for (const uint32_t i : which) {
      const auto chart = static_cast<size_t>(t.chart[i]);
      const float value = luminance(sum_of(samples, i));
      ++texels[chart];
      lit[chart] += value > 0 ? 1 : 0;
      light[chart] += double{value};
    }
  }
  bool reached(size_t chart) const {
    return static_cast<double>(lit[chart]) > kLitShare * static_cast<double>(texels[chart]);
  }
};

bool double_sided(const Atlas& atlas, const Texels& texels, size_t i) {
  const Fragment& f = texels.fragments[texels.first[i]];
  const scene::Mesh& mesh = atlas.scene.meshes[static_cast<size_t>(f.instance)];
  return atlas.scene.materials[static_cast<size_t>(mesh.material)].double_sided;
}

/// Turns charts to their back where light reaches only that, or that of a two-sided one is the
/// brighter: their samples become those of the back.
void choose_sides(const Baker& baker, const render::Integrator& integrator, const Atlas& atlas,
                  const Texels& texels, Samples* samples, TexelLight* out) {
  std::vector<uint32_t> all(texels.size());
  for (size_t i = 0; i < all.size(); ++i) all[i] = static_cast<uint32_t>(i);
  const ChartLight front(texels, *samples, all, atlas.charts);
  std::vector<uint8_t> two_sided(static_cast<size_t>(atlas.charts));
  for (size_t i = 0; i < texels.size(); ++i)
    two_sided[static_cast<size_t>(texels.chart[i])] |= double_sided(atlas, texels, i) ? 1 : 0;
  std::vector<uint32_t> asked;
  for (const uint32_t i : all) {
    const auto chart = static_cast<size_t>(texels.chart[i]);
    if (two_sided[chart] != 0 || !front.reached(chart)) asked.push_back(i);
  }
  Samples behind(texels.size(), !samples->direct[0].empty());
  const std::vector<uint8_t> back(static_cast<size_t>(atlas.charts), 1);
  for (int k = 0; k < 2; ++k)
    baker.pass(integrator, asked, back, baker.sampling(kBackRays), k, &behind);
  const ChartLight rear(texels, behind, asked, atlas.charts);
  for (size_t chart = 0; chart < back.size(); ++chart) {
    const bool both = front.reached(chart) && rear.reached(chart);
    if (both) out->two_sided += front.texels[chart];
    out->back[chart] =
        rear.reached(chart) && (!both || rear.light[chart] > front.light[chart]) ? 1 : 0;
  }
  for (const uint32_t i : asked) {
    if (out->back[static_cast<size_t>(texels.chart[i])] == 0) continue;
    for (size_t h = 0; h < 2; ++h) {
      samples->indirect[h][i] = behind.indirect[h][i];
      if (!samples->direct[h].empty()) samples->direct[h][i] = behind.direct[h][i];
    }
  }
}

/// Marks texels that light does not reach: those that have found little, by paths.
void find_darkness(const pathtrace::Bvh& bvh, const Texels& texels, const Samples& samples,
                   const std::vector<Vec3>& normals, const LightOptions& options, TexelLight* out) {
  double sum = 0;
  for (size_t i = 0; i < texels.size(); ++i) sum += double{luminance(sum_of(samples, i))};
  const float dim = kDim * static_cast<float>(sum / static_cast<double>(texels.size()));
  std::vector<size_t> which;
  std::vector<Vec3> position, normal;
  for (size_t i = 0; i < texels.size(); ++i) {
    if (luminance(sum_of(samples, i)) > dim) continue;
    which.push_back(i);
    position.push_back(texels.position[i]);
    normal.push_back(normals[i]);
  }
  if (which.empty()) return;
  pathtrace::ReachOptions reach;
  reach.max_depth = options.max_depth;
  reach.seed = hash_combine(options.seed, kReachPaths);
  const std::vector<uint8_t> keep =
      pathtrace::reached(bvh, position, normal, pathtrace::Sides::Front, reach);
  for (size_t k = 0; k < which.size(); ++k) out->dark[which[k]] = keep[k] == 0 ? 1 : 0;
}

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
  const Baker baker(scene, atlas, texels, options);
  Samples samples(texels.size(), false);
  render::PointSampling sampling = baker.sampling(kPathRays);
  sampling.light_samples = 0;
  for (int k = 0; k < options.passes; ++k) baker.pass(*paths, which, back, sampling, k, &samples);
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
  const Timer timer;
  const Baker baker(scene, atlas, texels, options);
  TexelLight out;
  out.irradiance.resize(texels.size());
  out.dark.resize(texels.size());
  out.back.resize(static_cast<size_t>(atlas.charts));
  std::vector<uint32_t> which(texels.size());
  for (size_t i = 0; i < which.size(); ++i) which[i] = static_cast<uint32_t>(i);
  Samples samples(texels.size(), options.direct);
  const int steps = options.passes + options.path_passes + 4;
  int step = 0;
  const auto done = [&] {
    ++step;
    if (!options.progress) return;
    const double time = timer.seconds() / options.seconds;
    options.progress(std::min(1.0, std::max(time, static_cast<double>(step) / steps)));
  };
  double last = 0;
  const auto one = [&](const render::Integrator& by, uint64_t stream, int number, Samples* into) {
    const Timer each;
    baker.pass(by, which, out.back, baker.sampling(stream), number, into);
    last = each.seconds();
    done();
  };
  if (options.back != nullptr) out.back = *options.back;
  for (int k = 0; k < 2; ++k) one(integrator, kRays, k, &samples);
  if (options.back == nullptr) choose_sides(baker, integrator, atlas, texels, &samples, &out);
  done();
  const std::vector<Vec3> normals = turned_normals(texels, out.back);
  find_darkness(scene.bvh, texels, samples, normals, options, &out);
  std::erase_if(which, [&](uint32_t i) { return out.dark[i] != 0; });
  const TexelGraph graph(scene.bvh, {texels.position, normals, texels.edge, out.dark});
  done();
  const double smoothing = 6e-6 * static_cast<double>(texels.size()) * (options.direct ? 2 : 1);
  const auto fits = [&](int more) {
    return timer.seconds() + more * last + smoothing <= options.seconds;
  };
  const auto even = [&](const Halves& halves) {
    return options.error > 0 && relative_error(halves) <= options.error;
  };
  Halves indirect;
  int next = 8;  // how well it is known is looked at when samples have doubled
  for (int k = 2; k < options.passes && fits(2); k += 2) {
    if (options.error > 0 && k >= next) {
      next *= 2;
      if (even(smooth(graph, samples.means(samples.indirect)))) break;
    }
    one(integrator, kRays, k, &samples);
    one(integrator, kRays, k + 1, &samples);
  }
  out.passes = samples.passes[0] + samples.passes[1];
  indirect = smooth(graph, samples.means(samples.indirect));
  if (integrator.method() != render::Method::Path && options.path_passes > 0) {
    const auto paths = render::make_path(scene, options.max_depth);
    LightOptions thin = options;
    thin.rays = 2;
    thin.direct = false;
    const Baker path_baker(scene, atlas, texels, thin);
    Samples traced(texels.size(), false);
    for (int k = 0; k < options.path_passes && fits(2); k += 2) {
      const Timer each;
      for (int h = 0; h < 2; ++h)
        path_baker.pass(*paths, which, out.back, path_baker.sampling(kPathRays), k + h, &traced);
      last = each.seconds() / 2;
      done();
      done();
    }
    out.path_passes = traced.passes[0] + traced.passes[1];
    if (out.path_passes > 0)
      indirect = correct(graph, std::move(indirect), traced.means(traced.indirect));
  }
  Halves all = indirect;
  if (options.direct) {
    const Halves direct = smooth(graph, samples.means(samples.direct));
    for (size_t h = 0; h < 2; ++h)
      for (size_t i = 0; i < direct[h].size(); ++i) all[h][i] += direct[h][i];
  }
  out.expected_error = std::hypot(relative_error(all),
                                  integrator.method() == render::Method::Path ? 0 : kSharedError);
  for (const uint32_t i : which) out.irradiance[i] = (all[0][i] + all[1][i]) * 0.5f;
  done();
  return out;
}

}  // namespace lte::bake
