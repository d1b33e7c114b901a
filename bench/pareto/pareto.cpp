#include "bench/pareto/pareto.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <set>

#include "lte/base/check.h"
#include "lte/base/checksum.h"
#include "lte/base/log.h"
#include "lte/base/timer.h"
#include "lte/cli/assets.h"
#include "lte/embed/untrained_light.h"

namespace lte::bench {

using namespace infer;

namespace {

/// A method that has taken so many seconds is not repeated.
constexpr double kLongEnough = 20;
constexpr int kWarmUpWidth = 32, kWarmUpHeight = 24;

template <typename Work>
Seconds measure(const Work& work) {
  const Stopwatch watch;
  work();
  return watch.seconds();
}

void keep_least(const Seconds& time, bool first, Seconds* least) {
  if (first || time.wall < least->wall) *least = time;
}

Seconds mean_of(const std::vector<Seconds>& times) {
  Seconds out;
  const double share = 1 / static_cast<double>(times.size());
  for (const Seconds& time : times) {
    out.wall += share * time.wall;
    out.processor += share * time.processor;
  }
  return out;
}

uint64_t checksum_of(const image::Image& image) {
  Checksum sum;
  sum.add(image.pixels.data(), image.pixels.size() * sizeof(float));
  return sum.value();
}

/// Small pictures of the first method of each family, so that none pays for what a process does
/// once.
void warm_up(const std::vector<Method>& methods, MethodScene scene, const scene::Camera& camera) {
  scene.width = std::min(scene.width, kWarmUpWidth);
  scene.height = std::min(scene.height, kWarmUpHeight);
  std::set<std::string> families;
  for (const Method& method : methods) {
    if (!families.insert(method.family).second) continue;
    method.prepare(scene);
    method.render(scene, camera, 0);
  }
}

/// One scene at one size with the references of its views.
struct Subject {
  const MethodScene& scene;
  std::vector<scene::Camera> cameras;
  std::vector<Reference> references;
};

ParetoRow measure_method(const Method& method, const Subject& subject, int repeats) {
  ParetoRow row;
  row.name = method.name;
  row.family = method.family;
  row.settings = method.settings;
  std::vector<Seconds> views(subject.cameras.size());
  ScoreMean whole, indirect;
  const Timer all;
  for (int repeat = 0; repeat < repeats; ++repeat) {
    if (repeat > 0 && all.seconds() > kLongEnough) break;
    const Seconds once = measure([&] { method.prepare(subject.scene); });
    keep_least(once, repeat == 0, &row.once);
    for (size_t v = 0; v < views.size(); ++v) {
      MethodPicture picture;
      keep_least(
          measure([&] { picture = method.render(subject.scene, subject.cameras[v], once.wall); }),
          repeat == 0, &views[v]);
      if (repeat > 0) continue;
      const Reference& reference = subject.references[v];
      whole.add(score_picture(picture.whole, reference.whole));
      indirect.add(score_picture(picture.indirect ? picture.indirect() : image::Image(),
                                 reference.indirect));
      row.pictures.push_back(checksum_of(picture.whole));
    }
  }
  row.view = mean_of(views);
  row.whole = whole.mean();
  row.indirect = indirect.mean();
  log_info(row.name, ": ", row.once.wall, " s once, ", row.view.wall, " s a view, relMSE ",
           row.whole.relmse);
  return row;
}

void add_share(double share, const ReferenceNoise& noise, ReferenceNoise* sum) {
  sum->mse += share * noise.mse;
  sum->relmse += share * noise.relmse;
}

ParetoChart measure_chart(const ParetoOptions& options, const std::vector<Method>& methods,
                          const MethodScene& scene, const std::string& name) {
  const pathtrace::Bvh& bvh = scene.renderer.bvh();
  ParetoChart chart;
  chart.scene = name;
  chart.width = scene.width;
  chart.height = scene.height;
  chart.triangles = bvh.scene().triangle_count();
  chart.lights = static_cast<int64_t>(bvh.scene().light_groups.size());
  Subject subject{scene,
                  pareto_views(bvh, options.camera, options.views,
                               static_cast<float>(scene.width) / static_cast<float>(scene.height)),
                  {}};
  for (size_t v = 0; v < subject.cameras.size(); ++v) {
    subject.references.push_back(find_reference(scene, subject.cameras[v], concat(name, "-view", v),
                                                options.reference_spp, options.references));
    const double share = 1 / static_cast<double>(subject.cameras.size());
    add_share(share, subject.references.back().whole_noise, &chart.whole_noise);
    add_share(share, subject.references.back().indirect_noise, &chart.indirect_noise);
  }
  warm_up(methods, scene, subject.cameras.front());
  for (const Method& method : methods) {
    try {
      chart.rows.push_back(measure_method(method, subject, options.repeats));
    } catch (const Error& error) {  // a time that is too short for this scene on this machine
      log_warning(method.name, " has no row: ", error.what());
    }
  }
  return chart;
}

}  // namespace

std::vector<ParetoChart> measure_pareto(const ParetoOptions& options) {
  const std::vector<Method> methods = choose_methods(options.methods);
  for (const auto& [width, height] : options.sizes)
    LTE_CHECK(width >= 11 && height >= 11, "--size ", width, "x", height,
              ": SSIM needs 11 pixels a side or more");
  std::vector<std::string> files = options.scenes;
  if (files.empty()) files = {asset_path("scenes/cornell_box.glb", "SCENE").string()};
  const runtime::Network network(checkpoint_or_shipped(options.checkpoint));
  std::vector<ParetoChart> charts;
  for (const std::string& file : files) {
    const scene::Scene scene = load_scene(file, options.loading);
    Renderer renderer(scene);
    LTE_CHECK(renderer.has_light(), file, ": nothing emits light, so there is no error to measure");
    const std::string note = embed::untrained_light_note(scene, network.metadata());
    if (!note.empty()) log_warning(note);
    for (const auto& [width, height] : options.sizes) {
      charts.push_back(measure_chart(
          options, methods, {renderer, network, width, height, options.max_depth, options.seed},
          scene.name));
    }
  }
  return charts;
}

std::vector<size_t> pareto_front(const std::vector<std::pair<double, double>>& points) {
  std::vector<size_t> order(points.size()), front;
  std::iota(order.begin(), order.end(), size_t{0});
  std::erase_if(order, [&](size_t i) {
    return !std::isfinite(points[i].first) || !std::isfinite(points[i].second);
  });
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return points[a] < points[b]; });
  for (const size_t i : order) {
    if (front.empty() || points[i].second < points[front.back()].second) front.push_back(i);
  }
  return front;
}

}  // namespace lte::bench
