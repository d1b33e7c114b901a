#include "infer/eval/baselines/denoised_paths.h"

#include "infer/eval/measure/scores.h"

namespace lte::infer {
namespace {

image::Image picture_of(std::span<const Vec3> values, const data::View& view) {
  image::Image out(view.width, view.height, 3);
  for (size_t i = 0; i < values.size(); ++i) out.set_rgb(i, values[i]);
  return out;
}

}  // namespace

std::vector<Rgb> denoised_paths(const image::Denoiser& denoiser, const data::View& view,
                                std::span<const Rgb> light) {
  const image::Image noisy = fill_mask(light, view.mask, view.width, view.height),
                     normal = picture_of(view.normal, view),
                     position = picture_of(view.position, view);
  const image::Image clean = denoiser.denoise({&noisy, &normal, &position, nullptr, nullptr});
  std::vector<Rgb> out;
  for (size_t i = 0; i < view.mask.size(); ++i) {
    if (view.mask[i]) out.push_back(clean.rgb(i));
  }
  return out;
}

}  // namespace lte::infer
