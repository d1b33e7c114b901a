#include "infer/bench/pareto/reference.h"

#include <cctype>
#include <utility>

#include <nlohmann/json.hpp>

#include "infer/bench/pareto/traced_picture.h"
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

uint64_t fingerprint(const MethodScene& scene, const scene::Camera& camera) {
  const TracedPicture picture = trace_picture(scene, camera, 1, hash_combine(kSeed, 2), {});
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

/// The mean of two pictures; their mean squared difference is four times its variance.
double merge(const image::Image& other, image::Image* image) {
  const double variance = image::mse(image->pixels, other.pixels) / 4;
  for (size_t i = 0; i < image->pixels.size(); ++i)
    image->pixels[i] = 0.5F * (image->pixels[i] + other.pixels[i]);
  return variance;
}

Reference trace_reference(const MethodScene& scene, const scene::Camera& camera,
                          const std::string& name, int half) {
  Progress progress("reference of " + name, int64_t{2} * scene.width * scene.height, "pixels");
  const auto done = [&progress](int64_t pixels) { progress.advance(pixels); };
  Reference out;
  TracedPicture first = trace_picture(scene, camera, half, hash_combine(kSeed, 0), done);
  out.whole = std::move(first.whole);
  out.indirect = std::move(first.indirect);
  const TracedPicture other = trace_picture(scene, camera, half, hash_combine(kSeed, 1), done);
  out.whole_mse = merge(other.whole, &out.whole);
  out.indirect_mse = merge(other.indirect, &out.indirect);
  return out;
}

Reference read_reference(const std::filesystem::path& path) {
  Reference out{image::read_exr(path), image::read_exr(path, "indirect")};
  try {
    const nlohmann::json noise =
        nlohmann::json::parse(image::read_exr_text(path, kNoise).value_or(""));
    out.whole_mse = noise.at("whole_mse");
    out.indirect_mse = noise.at("indirect_mse");
  } catch (const nlohmann::json::exception&) {
    throw Error(concat(path.string(), ": no reference of lte_bench pareto; delete it"));
  }
  return out;
}

}  // namespace

Reference find_reference(const MethodScene& scene, const scene::Camera& camera,
                         const std::string& name, const ReferenceSettings& settings) {
  const int half = (settings.spp + 1) / 2;
  const std::filesystem::path path =
      settings.cache /
      (file_words(name) + formatted("-%dx%d-%dspp-depth%d-%016llx.exr", scene.width, scene.height,
                                    2 * half, scene.max_depth,
                                    static_cast<unsigned long long>(fingerprint(scene, camera))));
  if (std::filesystem::exists(path)) return read_reference(path);
  make_directory(settings.cache);
  const Reference out = trace_reference(scene, camera, name, half);
  const nlohmann::json noise{{"whole_mse", out.whole_mse}, {"indirect_mse", out.indirect_mse}};
  image::write_exr(path, {{"", &out.whole}, {"indirect", &out.indirect}}, {{kNoise, noise.dump()}});
  log_info("reference: ", path.string());
  return out;
}

}  // namespace lte::infer
