#include "infer/eval/measure/reference_pair.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "lte/base/checksum.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/base/random.h"
#include "lte/base/text.h"
#include "lte/base/version.h"
#include "lte/cli/progress.h"
#include "lte/image/exr.h"
#include "lte/pathtrace/gbuffer.h"
#include "lte/pathtrace/irradiance.h"
#include "lte/pathtrace/render.h"
#include "lte/scene/fingerprint.h"
#include "lte/scene/load_camera.h"

namespace lte::infer {
namespace {

namespace fs = std::filesystem;
using image::Image;

constexpr const char* kHeader = "lteReferencePair";
constexpr uint64_t kSeeds = 0x7ef;
constexpr int kFormat = 1;
constexpr size_t kPointsAtOnce = 1 << 14;
constexpr const char* kRemedy = "; delete it, or name another folder";

std::string hexadecimal(const Checksum& sum) {
  return formatted("%016llx", static_cast<unsigned long long>(sum.value()));
}

/// What a file holds: for each kind of picture the mean of both, which can be looked at, and half
/// of their difference.
struct KeptPair {
  struct Layer {
    const char *mean, *half;
    Image ReferencePicture::*picture;
  };
  static constexpr std::array<Layer, 3> kLayers = {
      {{"", "half", &ReferencePicture::whole},
       {"indirect", "indirect_half", &ReferencePicture::indirect},
       {"irradiance", "irradiance_half", &ReferencePicture::irradiance}}};

  std::array<Image, 3> mean, half;
  size_t count = 0;  ///< of pictures: without irradiance 2

  explicit KeptPair(bool irradiance) : count(irradiance ? 3 : 2) {}

  void take(const ReferencePair& pair) {
    for (size_t k = 0; k < count; ++k) {
      const Image &a = pair[0].*kLayers[k].picture, &b = pair[1].*kLayers[k].picture;
      mean[k] = half[k] = a;
      for (size_t i = 0; i < a.pixels.size(); ++i) {
        mean[k].pixels[i] = 0.5F * (a.pixels[i] + b.pixels[i]);
        half[k].pixels[i] = 0.5F * (a.pixels[i] - b.pixels[i]);
      }
    }
  }

  ReferencePair pair() const {
    ReferencePair out;
    for (size_t k = 0; k < count; ++k) {
      Image &a = out[0].*kLayers[k].picture, &b = out[1].*kLayers[k].picture;
      a = b = mean[k];
      for (size_t i = 0; i < a.pixels.size(); ++i) {
        a.pixels[i] += half[k].pixels[i];
        b.pixels[i] -= half[k].pixels[i];
      }
    }
    return out;
  }

  std::string checksum() const {
    Checksum sum;
    for (const std::array<Image, 3>* pictures : {&mean, &half}) {
      for (const Image& picture : *pictures)
        sum.add(picture.pixels.data(), picture.pixels.size() * sizeof(float));
    }
    return hexadecimal(sum);
  }
};

/// What one path a pixel finds: another path tracer finds something else.
std::string traced_checksum(const Renderer& renderer, const scene::Camera& camera,
                            const PairSettings& settings) {
  const Image picture =
      pathtrace::render_reference(renderer.bvh(), renderer.lights(), camera, settings.width,
                                  settings.height, {1, settings.max_depth + 1, kSeeds});
  Checksum sum;
  sum.add(picture.pixels.data(), picture.pixels.size() * sizeof(float));
  return hexadecimal(sum);
}

std::string view_checksum(const Renderer& renderer, const scene::Camera& camera,
                          const PairSettings& settings) {
  const scene::Fingerprint scene = scene::fingerprint(renderer.bvh().scene());
  Checksum sum;
  sum.add(concat(kFormat, ' ', scene.geometry, scene.materials, scene.lights, ' ',
                 scene::camera_json(camera), ' ', settings.seed, ' ', settings.irradiance));
  return hexadecimal(sum);
}

/// Indirect irradiance at what pixel centres see.
Image traced_irradiance(const Renderer& renderer, const scene::Camera& camera,
                        const PairSettings& settings, uint64_t seed,
                        const std::function<void(int64_t)>& done) {
  Image out(settings.width, settings.height, 3);
  const pathtrace::GBuffer hits =
      pathtrace::trace_gbuffer(renderer.bvh(), camera, settings.width, settings.height);
  std::vector<Vec3> position, normal;
  std::vector<size_t> pixel;
  for (size_t i = 0; i < hits.mask.size(); ++i) {
    if (!hits.mask[i] || !(max_component(hits.albedo[i]) > 0)) continue;
    position.push_back(hits.position[i]);
    normal.push_back(hits.normal[i]);
    pixel.push_back(i);
  }
  pathtrace::IrradianceOptions options;
  options.rays = settings.paths;
  options.max_depth = settings.max_depth;
  options.seed = seed;
  options.variance = options.by_group = false;
  for (size_t first = 0; first < pixel.size(); first += kPointsAtOnce) {
    const size_t count = std::min(kPointsAtOnce, pixel.size() - first);
    const pathtrace::Irradiance found = pathtrace::estimate_irradiance(
        renderer.bvh(), renderer.lights(), std::span(position).subspan(first, count),
        std::span(normal).subspan(first, count), options, static_cast<int64_t>(first));
    for (size_t i = 0; i < count; ++i)
      out.set_rgb(pixel[first + i], found.indirect_sum(static_cast<int64_t>(i)));
    done(static_cast<int64_t>(count));
  }
  done(static_cast<int64_t>(hits.mask.size() - pixel.size()));
  return out;
}

ReferencePicture trace(Renderer* renderer, const scene::Camera& camera,
                       const PairSettings& settings, uint64_t seed,
                       const std::function<void(int64_t)>& done) {
  ReferencePicture out;
  pathtrace::RadianceLayers layers;
  out.whole = pathtrace::render_reference(
      renderer->bvh(), renderer->lights(), camera, settings.width, settings.height,
      {settings.paths, settings.max_depth + 1, seed}, done, &layers);
  out.indirect = std::move(layers.indirect);
  if (!settings.irradiance) return out;
  out.irradiance = traced_irradiance(*renderer, camera, settings, seed, done);
  return out;
}

/// As a file would give it back, so that kept ones are the same to the last bit.
KeptPair trace_pair(Renderer* renderer, const scene::Camera& camera, const std::string& name,
                    const PairSettings& settings) {
  std::optional<Progress> progress;
  if (settings.progress) progress.emplace("reference of " + name, settings.pair_pixels(), "pixels");
  const auto done = [&](int64_t count) {
    if (progress) progress->advance(count);
    if (settings.done) settings.done(count);
  };
  const uint64_t seeds = hash_combine(kSeeds, settings.seed);
  ReferencePair pair;
  for (uint64_t k = 0; k < pair.size(); ++k)
    pair[k] = trace(renderer, camera, settings, hash_combine(seeds, k), done);
  KeptPair out(settings.irradiance);
  out.take(pair);
  return out;
}

/// The header of a kept pair. @throws ReferenceFault unless it is one of this version
nlohmann::json header_of(const fs::path& path) {
  nlohmann::json header;
  try {
    header = nlohmann::json::parse(image::read_exr_text(path, kHeader).value_or(""));
  } catch (const std::exception&) {
    throw ReferenceFault(concat(path.string(), ": no reference, or a damaged one", kRemedy));
  }
  const std::string made = header.value("version", "");
  if (made != version() || header.value("format", 0) != kFormat)
    throw ReferenceFault(concat(path.string(), ": a reference of another version, lte ", made,
                                "; this is ", version(), kRemedy));
  return header;
}

ReferencePair read_pair(const fs::path& path, const std::string& traced, bool irradiance) {
  const nlohmann::json header = header_of(path);
  if (header.value("traced", "") != traced)
    throw ReferenceFault(concat(path.string(),
                                ": a reference by another path tracer, of another version or "
                                "machine",
                                kRemedy));
  KeptPair out(irradiance);
  try {
    for (size_t k = 0; k < out.count; ++k) {
      out.mean[k] = image::read_exr(path, KeptPair::kLayers[k].mean);
      out.half[k] = image::read_exr(path, KeptPair::kLayers[k].half);
    }
  } catch (const std::exception& error) {
    throw ReferenceFault(concat(error.what(), ": a damaged reference", kRemedy));
  }
  if (header.value("pictures", "") != out.checksum())
    throw ReferenceFault(concat(path.string(),
                                ": a damaged reference: its pictures are not those "
                                "that were written",
                                kRemedy));
  return out.pair();
}

}  // namespace

image::Image mean_of_pair(const image::Image& a, const image::Image& b) {
  image::Image out = a;
  for (size_t i = 0; i < out.pixels.size(); ++i)
    out.pixels[i] = 0.5F * (out.pixels[i] + b.pixels[i]);
  return out;
}

std::string file_words(const std::string& text) {
  std::string out;
  for (const char c : text) out += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  return out;
}

std::string pair_fingerprint(const Renderer& renderer, const scene::Camera& camera,
                             const PairSettings& settings) {
  Checksum sum;
  sum.add(concat(version(), ' ', view_checksum(renderer, camera, settings), ' ', settings.width,
                 'x', settings.height, ' ', settings.paths, ' ', settings.max_depth, ' ',
                 traced_checksum(renderer, camera, settings)));
  return hexadecimal(sum);
}

ReferencePair find_reference_pair(Renderer* renderer, const scene::Camera& camera,
                                  const std::string& name, const PairSettings& settings) {
  if (settings.folder.empty()) return trace_pair(renderer, camera, name, settings).pair();
  const fs::path path =
      settings.folder / (file_words(name) +
                         formatted("-%dx%d-%dspp-depth%d-", settings.width, settings.height,
                                   2 * settings.paths, settings.max_depth) +
                         view_checksum(*renderer, camera, settings) + ".exr");
  const std::string traced = traced_checksum(*renderer, camera, settings);
  if (fs::exists(path)) return read_pair(path, traced, settings.irradiance);
  make_directory(settings.folder);
  const KeptPair kept = trace_pair(renderer, camera, name, settings);
  const nlohmann::json header{{"format", kFormat},
                              {"version", version()},
                              {"traced", traced},
                              {"pictures", kept.checksum()}};
  std::vector<image::Layer> layers;
  for (size_t k = 0; k < kept.count; ++k) {
    layers.push_back({KeptPair::kLayers[k].mean, &kept.mean[k]});
    layers.push_back({KeptPair::kLayers[k].half, &kept.half[k]});
  }
  image::write_exr(path, layers, {{kHeader, header.dump()}});
  if (settings.progress) log_info("reference: ", path.string());
  return kept.pair();
}

void check_kept_pairs(const fs::path& folder) {
  if (folder.empty() || !fs::is_directory(folder)) return;
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".exr") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) header_of(file);
}

}  // namespace lte::infer
