// What a table of radiosity, a final gather over it and a correction by residuals are worth: the
// experiments of docs/lab/gather.md. Prints a table a scene.
//
// usage: lte_gather_bench [--model FILE] [--cache FOLDER] [--size WxH] SCENE ...
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "infer/light/lit_samples.h"
#include "infer/light/network_table.h"
#include "infer/light/untrained_light.h"
#include "infer/renderer/renderer.h"
#include "infer/tool/assets.h"
#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/base/timer.h"
#include "lte/cli/scene_flags.h"
#include "lte/gi/gather.h"
#include "lte/gi/radiosity_table.h"
#include "lte/gi/residual.h"
#include "lte/gi/surface_index.h"
#include "tests/bench/gather_reference.h"

namespace {

using namespace lte;
using namespace lte::bench;

void print_row(const std::string& name, const Score& s, double seconds, double million_rays) {
  const auto number = [](const char* format, double value) {
    char text[32];
    std::snprintf(text, sizeof(text), format, value);
    return std::string(text);
  };
  std::printf("| %s | %s | %s | %.2e | %.4f |\n", name.c_str(),
              seconds > 0 ? number("%.2f", seconds).c_str() : "",
              million_rays > 0 ? number("%.2f", million_rays).c_str() : "", s.mse, s.relmse);
  std::fflush(stdout);
}

/// The mean of `values` at the `k` points nearest to a place, weighted by closeness.
std::vector<Rgb> nearest_means(const gi::TableEntries& entries, const std::vector<Rgb>& values,
                               const View& view, size_t k) {
  std::vector<float> radii;
  for (const float area : entries.area)
    radii.push_back(1.5f * std::sqrt(static_cast<float>(k) * area));
  const gi::SurfaceIndex index(entries.position, entries.normal, radii);
  std::vector<Rgb> out(view.position.size());
  parallel_for(static_cast<int64_t>(out.size()), 64, [&](int64_t begin, int64_t end) {
    struct Near {
      float distance2;
      uint32_t entry;
    };
    std::vector<Near> near;
    for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i) {
      near.clear();
      index.for_each(view.position[i], view.normal[i],
                     [&](uint32_t entry, float, const Vec3& offset) {
                       near.push_back({dot(offset, offset), entry});
                     });
      std::sort(near.begin(), near.end(),
                [](const Near& a, const Near& b) { return a.distance2 < b.distance2; });
      if (near.size() > k + 1) near.resize(k + 1);
      if (near.empty()) continue;
      const float edge2 = near.back().distance2 * 1.0001f;
      Rgb sum;
      float weights = 0;
      for (const Near& n : near) {
        const float weight = (1 - n.distance2 / edge2) * (1 - n.distance2 / edge2);
        sum += values[n.entry] * weight;
        weights += weight;
      }
      out[i] = weights > 0 ? sum / weights : values[near[0].entry];
    }
  });
  return out;
}

/// One scene's experiments.
class Experiments {
 public:
  Experiments(const scene::Scene& scene, const runtime::Network& network, int width, int height,
              const std::filesystem::path& cached)
      : bvh_(scene),
        lights_(scene),
        network_(network),
        view_(look(bvh_, width, height)),
        reference_(reference_of(bvh_, lights_, view_, cached)) {}

  void run() {
    std::printf("%zu pixels, %lld triangles\n\n", view_.position.size(),
                static_cast<long long>(bvh_.scene().triangle_count()));
    std::printf("| method | s | M rays | MSE | relMSE |\n|---|---:|---:|---:|---:|\n");
    path_tracing();
    encode();
    blur_of_the_true_residual();
    estimates_alone();
    gathers();
    residuals();
  }

 private:
  using Work = std::function<std::vector<Rgb>(int64_t* rays)>;

  void row(const std::string& name, bool one_more, double before_s, const Work& work,
           int64_t rays_before = 0) {
    int64_t rays = rays_before;
    const double start = processor_seconds();
    const std::vector<Rgb> values = work(&rays);
    const double seconds = before_s + processor_seconds() - start;
    print_row(name, score(values, reference_, one_more), seconds, 1e-6 * static_cast<double>(rays));
  }

  /// Indirect irradiance of the view by paths that no table ends.
  std::vector<Rgb> traced(int paths, uint64_t seed, int64_t* rays) const {
    const gi::RadiosityTable none(bvh_, {}, {});
    gi::GatherOptions options;
    options.rays = paths;
    options.max_depth = kModelDepth;
    options.seed = seed;
    gi::Gathered gathered =
        gi::gather_irradiance(bvh_, lights_, none, view_.position, view_.normal, options);
    *rays += gathered.rays_traced;
    return std::move(gathered.indirect);
  }

  void path_tracing() {
    for (const int paths : {4, 16, 64, 256}) {
      row("path tracing, " + std::to_string(paths) + " paths a pixel", false, 0,
          [&](int64_t* rays) { return traced(paths, 7, rays); });
    }
  }

  void encode() {
    const auto make = [&] {
      scene::SurfaceSamples samples =
          infer::sample_scene_points(bvh_, network_.metadata().scene_points,
                                     network_.metadata().scene_points_pruned, 0, nullptr);
      infer::leave_out_untrained_suns(bvh_.scene(), network_.metadata(), &samples);
      const infer::LitSamples lit = infer::add_light_estimates(bvh_, lights_, std::move(samples),
                                                               network_.light_request(), 0);
      return runtime::SceneEmbedding(network_, lit.points(), {.rescale = true});
    };
    make();  // warm-up
    const double start = processor_seconds();
    embedding_.clear();
    embedding_.add(std::make_shared<const runtime::SceneEmbedding>(make()));
    encode_s_ = processor_seconds() - start;
    row("network at every pixel", false, encode_s_, [&](int64_t*) {
      return answers_ = embedding_.decode({view_.position, view_.normal, view_.albedo});
    });
  }

  void blur_of_the_true_residual() {
    const double spacing = std::sqrt(scene::surface_area(bvh_.scene()) / 4096);
    std::vector<Rgb> residual(answers_.size());
    for (size_t i = 0; i < residual.size(); ++i)
      residual[i] = reference_.half[0][0][i] - answers_[i];
    for (const float radius : {0.0f, 0.125f, 0.25f, 0.5f, 1.0f, 2.0f, 4.0f}) {
      std::vector<Rgb> corrected(answers_);
      if (radius > 0) {
        const gi::SurfaceIndex index(
            view_.position, view_.normal,
            std::vector<float>(residual.size(), radius * static_cast<float>(spacing)));
        parallel_for(index.size(), 64, [&](int64_t begin, int64_t end) {
          for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i) {
            Rgb sum;
            float weights = 0;
            index.for_each(view_.position[i], view_.normal[i],
                           [&](uint32_t j, float weight, const Vec3&) {
                             sum += residual[j] * weight;
                             weights += weight;
                           });
            if (weights > 0) corrected[i] += sum / weights;
          }
        });
      } else {
        corrected = reference_.half[0][0];
      }
      char name[96];
      std::snprintf(name, sizeof(name), "network + true residual blurred over %.3g m",
                    double{radius} * spacing);
      print_row(name, score_against_second(corrected, reference_), 0, 0);
    }
  }

  struct Lit {
    gi::TableEntries entries;
    gi::EntryLight light;
    double seconds = 0;
  };

  /// Estimates at `count` entries.
  Lit lit_entries(int64_t count, int paths) const {
    Lit out;
    const double start = processor_seconds();
    out.entries = gi::sample_entries(bvh_, count, 11);
    out.light = gi::estimate_entries(bvh_, lights_, out.entries, paths, kModelDepth, 12);
    out.seconds = processor_seconds() - start;
    return out;
  }

  void estimates_alone() {
    struct Plan {
      int64_t points;
      int paths;
    };
    for (const Plan& plan : {Plan{1024, 256}, Plan{4096, 64}, Plan{16384, 16}}) {
      const Lit lit = lit_entries(2 * plan.points, plan.paths);
      for (const size_t k : {8, 16, 32}) {
        row(
            "estimates, " + std::to_string(plan.points) + " points x " +
                std::to_string(plan.paths) + " paths a side, " + std::to_string(k) + " nearest",
            false, lit.seconds,
            [&](int64_t*) { return nearest_means(lit.entries, lit.light.indirect, view_, k); },
            lit.light.rays_traced);
      }
    }
  }

  void gather_rows(const std::string& name, const gi::RadiosityTable& table, double before_s,
                   int64_t rays_before, bool all_options) {
    const auto add = [&](int rays_a_pixel, float near) {
      gi::GatherOptions options;
      options.rays = rays_a_pixel;
      options.near = near;
      options.seed = 5;
      char text[64];
      std::snprintf(text, sizeof(text), ", %d rays, near %.2g", rays_a_pixel, double{near});
      row(
          name + text, true, before_s,
          [&](int64_t* rays) {
            gi::Gathered gathered =
                gi::gather_irradiance(bvh_, lights_, table, view_.position, view_.normal, options);
            *rays += gathered.rays_traced;
            misses_ = static_cast<double>(gathered.misses) /
                      static_cast<double>(std::max<int64_t>(1, gathered.lookups));
            return std::move(gathered.indirect);
          },
          rays_before);
    };
    const float near = gi::GatherOptions().near;
    add(16, near);
    add(64, near);
    if (!all_options) return;
    add(64, 0);
    add(64, INFINITY);
    add(256, near);
  }

  /// Nanoseconds of a look-up beside those of a path.
  void time_lookups(const gi::RadiosityTable& table) const {
    constexpr int kRepeats = 20;
    double start = processor_seconds();
    Rgb sum;
    int64_t found = 0;
    for (int k = 0; k < kRepeats; ++k) {
      for (size_t i = 0; i < view_.position.size(); ++i) {
        Rgb e;
        if (!table.lookup(view_.position[i], view_.normal[i], &e)) continue;
        sum += e;
        ++found;
      }
    }
    const auto lookups = static_cast<double>(kRepeats * view_.position.size());
    const double lookup_ns = 1e9 * (processor_seconds() - start) / lookups;
    start = processor_seconds();
    int64_t rays = 0;
    const size_t pixels = traced(16, 3, &rays).size();
    const double path_ns = 1e9 * (processor_seconds() - start) / static_cast<double>(16 * pixels);
    notes_.push_back(concat("table of ", table.size(), " entries: ", lookup_ns, " ns a look-up (",
                            100 * static_cast<double>(found) / lookups, " % answered), ", path_ns,
                            " ns a path, ",
                            static_cast<double>(rays) / static_cast<double>(16 * pixels),
                            " rays a path (sum ", sum.x, ")"));
  }

  void gathers() {
    for (const int64_t count : {4096, 16384}) {
      const std::string size = std::to_string(count);
      {
        const Lit best = lit_entries(count, count > 5000 ? 256 : 512);
        const gi::RadiosityTable table(bvh_, best.entries, best.light.total(), best.light.direct);
        time_lookups(table);
        gather_rows("gather, reference at " + size + " entries", table, 0, 0, count < 5000);
        notes_.push_back(concat("misses at ", count, " entries: ", 100 * misses_, " %"));
      }
      const int paths = count > 5000 ? 16 : 64;
      const Lit raw = lit_entries(count, paths);
      {
        const double start = processor_seconds();
        const gi::RadiosityTable table(bvh_, raw.entries, raw.light.total(), raw.light.direct);
        gather_rows("gather, " + std::to_string(paths) + " paths at " + size + " entries", table,
                    raw.seconds + processor_seconds() - start, raw.light.rays_traced, false);
      }
      const double start = processor_seconds();
      const gi::RadiosityTable table =
          infer::network_table(bvh_, lights_, embedding_, {.entries = count, .seed = 11});
      gather_rows("gather, network at " + size + " entries", table,
                  encode_s_ + processor_seconds() - start, 0, false);
    }
  }

  using Batch = std::function<std::vector<Rgb>(uint64_t batch, int64_t* rays)>;

  /// Estimates at pixels, corrected or smoothed from pixel to pixel.
  void smoothed_row(const std::string& name, bool with_network, bool one_more, int batches,
                    double before_s, int64_t rays_before, const Batch& estimates) {
    const std::vector<Rgb> base = with_network ? answers_ : std::vector<Rgb>(view_.position.size());
    row((with_network ? "network" : "nothing") + (" + residual at pixels, " + name), one_more,
        before_s + (with_network ? encode_s_ : 0),
        [&](int64_t* rays) {
          gi::ResidualField field(view_.position, view_.normal, view_.spacing);
          for (int k = 0; k < batches; ++k)
            field.add(estimates(1000 + static_cast<uint64_t>(k), rays), base);
          std::vector<Rgb> out = field.correct_points();
          for (size_t i = 0; i < out.size(); ++i) out[i] += base[i];
          notes_.push_back(concat(with_network ? "network" : "nothing", ", ", name, ": radius ",
                                  field.radius_in_spacings(), " spacings"));
          return out;
        },
        rays_before);
  }

  /// Corrections of the network, and of nothing, by the same rays.
  void residuals() {
    for (const int batches : {4, 16, 64}) {
      for (const bool with_network : {false, true}) {
        smoothed_row(std::to_string(batches) + " x 2 paths", with_network, false, batches, 0, 0,
                     [&](uint64_t k, int64_t* rays) { return traced(2, k, rays); });
      }
    }
    const Lit raw = lit_entries(4096, 64);
    const gi::RadiosityTable by_paths(bvh_, raw.entries, raw.light.total(), raw.light.direct);
    const gi::RadiosityTable by_network =
        infer::network_table(bvh_, lights_, embedding_, {.entries = 4096, .seed = 11});
    for (const int gather_rays : {2, 4, 16}) {
      for (const bool with_network : {false, true}) {
        const gi::RadiosityTable& table = with_network ? by_network : by_paths;
        smoothed_row("4 x " + std::to_string(gather_rays) + " gather rays, " +
                         (with_network ? "network" : "64 paths") + " at 4096 entries",
                     with_network, true, 4, with_network ? 0 : raw.seconds,
                     with_network ? 0 : raw.light.rays_traced, [&](uint64_t k, int64_t* rays) {
                       gi::GatherOptions options;
                       options.rays = gather_rays;
                       options.seed = k;
                       gi::Gathered gathered = gi::gather_irradiance(
                           bvh_, lights_, table, view_.position, view_.normal, options);
                       *rays += gathered.rays_traced;
                       return std::move(gathered.indirect);
                     });
      }
    }
    const gi::TableEntries all = gi::sample_entries(bvh_, 8192, 21);
    const std::vector<Rgb> at_points = embedding_.decode({all.position, all.normal, all.albedo});
    std::vector<float> spacing;
    for (const float area : all.area) spacing.push_back(std::sqrt(area));
    const std::vector<Rgb> none(at_points.size());
    for (const bool with_network : {false, true}) {
      const std::vector<Rgb>& base = with_network ? at_points : none;
      row(std::string(with_network ? "network" : "nothing") +
              " + residual at 4096 points, 8 x 8 paths a side",
          false, with_network ? encode_s_ : 0, [&](int64_t* rays) {
            gi::ResidualField field(all.position, all.normal, spacing);
            for (int k = 0; k < 8; ++k) {
              const gi::EntryLight light = gi::estimate_entries(bvh_, lights_, all, 8, kModelDepth,
                                                                3000 + static_cast<uint64_t>(k));
              field.add(light.indirect, base);
              *rays += light.rays_traced;
            }
            field.correct_points();
            std::vector<Rgb> out = field.correct(view_.position, view_.normal);
            if (with_network) {
              for (size_t i = 0; i < out.size(); ++i) out[i] += answers_[i];
            }
            return out;
          });
    }
    std::printf("\n");
    for (const std::string& note : notes_) std::printf("    %s\n", note.c_str());
    std::printf("\n");
  }

  pathtrace::Bvh bvh_;
  pathtrace::Lights lights_;
  const runtime::Network& network_;
  View view_;
  Reference reference_;
  infer::EmbeddingDraws embedding_;
  std::vector<Rgb> answers_;
  double encode_s_ = 0, misses_ = 0;
  mutable std::vector<std::string> notes_;
};

}  // namespace

int main(int argc, char** argv) {
  std::string model, size = "160x120";
  std::filesystem::path cache = "out/gather";
  std::vector<std::filesystem::path> scenes;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto value = [&] { return std::string(i + 1 < argc ? argv[++i] : ""); };
    if (word == "--model") {
      model = value();
    } else if (word == "--cache") {
      cache = value();
    } else if (word == "--size") {
      size = value();
    } else {
      scenes.emplace_back(word);
    }
  }
  try {
    int width = 0, height = 0;
    LTE_CHECK(std::sscanf(size.c_str(), "%dx%d", &width, &height) == 2, "--size ", size,
              ": expected WIDTHxHEIGHT");
    const runtime::Network network(infer::checkpoint_or_shipped(model));
    for (const auto& path : scenes) {
      const scene::Scene scene = load_scene(path, {});
      std::printf("## %s\n\n", path.filename().c_str());
      Experiments(scene, network, width, height,
                  cache / concat(path.stem().string(), '-', size, '-', kHalfPaths, ".f32"))
          .run();
    }
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "lte_gather_bench: %s\n", error.what());
    return 1;
  }
}
