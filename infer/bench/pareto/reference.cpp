#include "infer/bench/pareto/reference.h"

#include <cctype>
#include <utility>

#include <nlohmann/json.hpp>

#include "infer/bench/pareto/traced_picture.h"
#include "infer/picture/picture_score.h"
#include "lte/base/check.h"
#include "lte/base/checksum.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/base/random.h"
#include "lte/base/text.h"
#include "lte/cli/progress.h"
#include "lte/image/exr.h"
#include "lte/image/metrics.h"

namespace lte::infer {
namespace {

constexpr const char* kNoise = "lteReferenceNoise";
/// Seeds of the halves and of the fingerprint, which no method shares.
constexpr uint64_t kSeed = 0x7ef;
/// Of the fingerprint: another one wherever the file says something else than before.
constexpr uint64_t kFileVersion = 3;

uint64_t fingerprint(const MethodScene& scene, const scene::Camera& camera) {
  const TracedPicture picture =
      trace_picture(scene, camera, 1, hash_combine(kSeed, kFileVersion), {});
  Checksum sum;
  for (const image::Image* image : {&picture.whole, &picture.indirect})
    sum.add(image->pixels.data(), image->pixels.size() * sizeof(float));
  return sum.value();
}

std::string file_words(const std::string& name) {
  std::string out;
  for (const char c : name) out += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  return out;
}

/// Makes `image` the mean of both pictures. Half of their difference has the noise of that mean.
ReferenceNoise merge(const image::Image& other, image::Image* image) {
  image::Image moved = other;  // the mean and its noise, as a picture of the same light
  for (size_t i = 0; i < image->pixels.size(); ++i) {
    const float mean = 0.5F * (image->pixels[i] + other.pixels[i]);
    moved.pixels[i] = mean + 0.5F * (image->pixels[i] - other.pixels[i]);
    image->pixels[i] = mean;
  }
  return {image::mse(moved.pixels, image->pixels), relative_mse(moved, *image)};
}

nlohmann::json attribute_of(const ReferenceNoise& noise) {
  return {{"mse", noise.mse}, {"relmse", noise.relmse}};
}

ReferenceNoise noise_of(const nlohmann::json& json) { return {json.at("mse"), json.at("relmse")}; }

Reference trace_reference(const MethodScene& scene, const scene::Camera& camera,
                          const std::string& name, int half) {
  Progress progress("reference of " + name, int64_t{2} * scene.width * scene.height, "pixels");
  const auto done = [&progress](int64_t pixels) { progress.advance(pixels); };
  Reference out;
  TracedPicture first = trace_picture(scene, camera, half, hash_combine(kSeed, 0), done);
  out.whole = std::move(first.whole);
  out.indirect = std::move(first.indirect);
  const TracedPicture other = trace_picture(scene, camera, half, hash_combine(kSeed, 1), done);
  out.whole_noise = merge(other.whole, &out.whole);
  out.indirect_noise = merge(other.indirect, &out.indirect);
  return out;
}

Reference read_reference(const std::filesystem::path& path) {
  Reference out{image::read_exr(path), image::read_exr(path, "indirect"), {}, {}};
  try {
    const nlohmann::json noise =
        nlohmann::json::parse(image::read_exr_text(path, kNoise).value_or(""));
    out.whole_noise = noise_of(noise.at("whole"));
    out.indirect_noise = noise_of(noise.at("indirect"));
  } catch (const nlohmann::json::exception&) {
    throw Error(concat(path.string(), ": no reference of lte_bench pareto; delete it"));
  }
  return out;
}

}  // namespace

Reference find_reference(const MethodScene& scene, const scene::Camera& camera,
                         const std::string& name, const ReferenceSettings& settings) {
  const int half = (settings.spp + 1) / 2;
  if (settings.cache.empty()) return trace_reference(scene, camera, name, half);
  const std::filesystem::path path =
      settings.cache /
      (file_words(name) + formatted("-%dx%d-%dspp-depth%d-%016llx.exr", scene.width, scene.height,
                                    2 * half, scene.max_depth,
                                    static_cast<unsigned long long>(fingerprint(scene, camera))));
  if (std::filesystem::exists(path)) return read_reference(path);
  make_directory(settings.cache);
  const Reference out = trace_reference(scene, camera, name, half);
  const nlohmann::json noise{{"whole", attribute_of(out.whole_noise)},
                             {"indirect", attribute_of(out.indirect_noise)}};
  image::write_exr(path, {{"", &out.whole}, {"indirect", &out.indirect}}, {{kNoise, noise.dump()}});
  log_info("reference: ", path.string());
  return out;
}

}  // namespace lte::infer
