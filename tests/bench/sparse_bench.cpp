// What sparse answers cost in error, and what they save: docs/lab/sparse-answers.md.
//
// usage: lte_sparse_bench WxH PATHS SCENE[:CAMERA] ... encodes each scene once, answers one view's
// pixels by a row of settings, and compares indirect irradiance, times albedo/π, with PATHS paths a
// pixel. The noise of these is subtracted, as estimated from their two halves.
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "infer/renderer/renderer.h"
#include "infer/tool/assets.h"
#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/base/timer.h"
#include "lte/cli/scene_flags.h"
#include "lte/gi/upsample.h"
#include "lte/pathtrace/gbuffer.h"
#include "lte/pathtrace/placement/auto_camera.h"

namespace {

using namespace lte;
using infer::Frame;
using infer::Renderer;
using infer::RenderSettings;

struct Row {
  std::string name;
  std::optional<gi::SparseOptions> options;
};

gi::SparseOptions options(int step, int edge_step, float tolerance, int contacts) {
  gi::SparseOptions out;
  out.step = step;
  out.edge_step = edge_step;
  out.tolerance = tolerance;
  out.contact_radius = contacts;
  return out;
}

std::vector<Row> rows() {
  std::vector<Row> out{{"every pixel", std::nullopt}};
  for (const int stride : {2, 4, 8, 16})
    out.push_back({concat("stride ", stride), options(stride, 64, INFINITY, -1)});
  for (const int edge : {0, 2, 4})
    out.push_back({concat("8, edges to ", edge), options(8, edge, INFINITY, -1)});
  for (const float tolerance : {0.4f, 0.2f})
    out.push_back({concat("8, edges to 4, tolerance ", tolerance), options(8, 4, tolerance, -1)});
  for (const float tolerance : {0.2f, 0.1f, 0.05f})
    out.push_back({concat("8, edges to 2, tolerance ", tolerance), options(8, 2, tolerance, -1)});
  for (const int radius : {0, 1}) {
    out.push_back(
        {concat("8, edges to 2, tolerance 0.1, contacts ", radius), options(8, 2, 0.1f, radius)});
  }
  return out;
}

double mean_square(const image::Image& a, const image::Image& b) {
  double sum = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i) {
    const double d = double{a.pixels[i]} - double{b.pixels[i]};
    sum += d * d;
  }
  return sum / static_cast<double>(a.pixels.size());
}

/// Mean of (a − b)² / (reference² + 0.01).
double relative(const image::Image& a, const image::Image& b, const image::Image& reference) {
  double sum = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i) {
    const double d = double{a.pixels[i]} - double{b.pixels[i]};
    sum += d * d / (double{reference.pixels[i]} * reference.pixels[i] + 0.01);
  }
  return sum / static_cast<double>(a.pixels.size());
}

struct Reference {
  image::Image mean, half_a, half_b;
};

Reference reference_of(Renderer* renderer, const scene::Camera& camera, RenderSettings settings,
                       int paths) {
  settings.mode = infer::Mode::Reference;
  settings.spp = paths / 2;
  Reference out;
  out.half_a = renderer->render(camera, settings).color;
  settings.seed = 1;
  out.half_b = renderer->render(camera, settings).color;
  out.mean = out.half_a;
  for (size_t i = 0; i < out.mean.pixels.size(); ++i)
    out.mean.pixels[i] = 0.5f * (out.half_a.pixels[i] + out.half_b.pixels[i]);
  return out;
}

/// Times filling of all pixels from every eighth column and row, on one thread.
void time_upsampling(const pathtrace::Bvh& bvh, const scene::Camera& camera, int width,
                     int height) {
  const pathtrace::GBuffer hits = pathtrace::trace_gbuffer(bvh, camera, width, height);
  const gi::PixelSurfaces surfaces{width,
                                   height,
                                   hits.position,
                                   hits.normal,
                                   hits.depth,
                                   hits.mask,
                                   pathtrace::pixel_size(camera, height)};
  constexpr int kRuns = 5;
  double seconds = 0;
  size_t holes = 0;
  set_num_threads(1);
  for (int run = 0; run < kRuns; ++run) {
    std::vector<uint8_t> known(surfaces.size());
    std::vector<Rgb> values(surfaces.size(), Rgb{1, 1, 1});
    for (int y = 0; y < height; y += 8) {
      for (int x = 0; x < width; x += 8) known[surfaces.at(x, y)] = hits.mask[surfaces.at(x, y)];
    }
    const double before = processor_seconds();
    holes = gi::upsample(surfaces, 8, known, values).size();
    seconds += processor_seconds() - before;
  }
  set_num_threads(0);
  std::printf("upsampling, one thread: %.1f ms of processor time, %zu holes\n",
              1000 * seconds / kRuns, holes);
}

void measure(const std::string& name, const runtime::Network& network, int width, int height,
             int paths) {
  const auto colon = name.find(':');
  const scene::Scene scene = load_scene(name.substr(0, colon), {});
  Renderer renderer(scene);
  scene::Camera camera;
  if (colon != std::string::npos) {
    camera = scene.cameras.at(static_cast<size_t>(std::atoi(name.c_str() + colon + 1)));
  } else {
    camera = scene.cameras.empty() ? pathtrace::auto_camera(renderer.bvh()) : scene.cameras[0];
  }
  RenderSettings settings;
  settings.output = infer::Output::Gi;
  settings.width = width;
  settings.height = height;
  settings.antialias = 0;
  settings.metal = infer::Metal::Diffuse;
  settings.layers = false;
  const Reference truth = reference_of(&renderer, camera, settings, paths);
  infer::EmbedSettings embed;
  embed.rescale = true;
  renderer.embed(network, embed);
  std::printf("\n%s, camera %s, %dx%d, %d paths\n", name.c_str(), camera.name.c_str(), width,
              height, paths);
  std::printf(
      "| pixels answered | answered | of all | processor s | whole, s | mse | loss | "
      "relmse | loss |\n|---|---:|---:|---:|---:|---:|---:|---:|---:|\n");
  const double noise = mean_square(truth.half_a, truth.half_b) / 4,
               relative_noise = relative(truth.half_a, truth.half_b, truth.mean) / 4;
  double every = 0, relative_every = 0;
  for (const Row& row : rows()) {
    settings.sparse = row.options;
    const double before = processor_seconds();
    const Frame frame = renderer.render(camera, settings);
    const double seconds = processor_seconds() - before;
    const double mse = mean_square(frame.color, truth.mean) - noise;
    const double relmse = relative(frame.color, truth.mean, truth.mean) - relative_noise;
    if (!row.options) {
      every = mse;
      relative_every = relmse;
    }
    std::printf("| %s | %lld | %.1f %% | %.2f | %.4g | %+.1f %% | %.4g | %+.1f %% |\n",
                row.name.c_str(), static_cast<long long>(frame.decoded),
                100.0 * static_cast<double>(frame.decoded) / static_cast<double>(frame.queries),
                seconds, mse, 100 * (mse / every - 1), relmse, 100 * (relmse / relative_every - 1));
    std::fflush(stdout);
  }
  time_upsampling(renderer.bvh(), camera, width, height);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    int width = 0, height = 0;
    LTE_CHECK(argc >= 4 && std::sscanf(argv[1], "%dx%d", &width, &height) == 2,
              "usage: lte_sparse_bench WxH PATHS SCENE[:CAMERA] ...");
    const char* model = std::getenv("LTE_MODEL");
    const runtime::Network network(infer::checkpoint_or_shipped(model != nullptr ? model : ""));
    for (int i = 3; i < argc; ++i) measure(argv[i], network, width, height, std::atoi(argv[2]));
    return EXIT_SUCCESS;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "lte_sparse_bench: %s\n", error.what());
    return EXIT_FAILURE;
  }
}
