#include "infer/view/residual.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "infer/renderer/path_correction.h"
#include "lte/base/random.h"

namespace lte::infer::view {
namespace {

using image::Image;

// Independent of all that pictures draw.
constexpr uint64_t kAnswers = 51;
constexpr float kChecked = 1 << 14;  // pixels whose answers are checked, about

Image scaled(const Image& sum, float factor) {
  Image out = sum;
  for (float& value : out.pixels) value *= factor;
  return out;
}

}  // namespace

/// What answers at every pixel, and where it stands for a surface's light.
void Residual::answer(const SessionState& state, const scene::Camera& camera,
                      const RenderSettings& settings) {
  if (answer_.width > 0) return;
  SurfaceGuides guides = trace_guides(state.bvh(), camera, settings.width, settings.height);
  RenderSettings network = settings;
  network.output = Output::Irradiance;
  network.sparse.reset();
  network.antialias = 0;
  network.layers = false;
  const bool gathers = state.answered_by() && state.answered_by() != PictureLight::Decoded;
  const int answers = gathers ? kGathered : 1;
  Image sum;
  for (int k = 0; k < answers; ++k) {
    network.seed = hash_combine(kAnswers, static_cast<uint64_t>(k));
    Image one = state.render(camera, network).color;
    if (sum.width == 0) sum = Image(one.width, one.height, one.channels);
    for (size_t i = 0; i < one.pixels.size(); ++i) sum.pixels[i] += one.pixels[i];
  }
  guides_ = std::move(guides);
  reflects_.resize(guides_.pixels());
  for (size_t i = 0; i < reflects_.size(); ++i) {
    const float* albedo = guides_.albedo.pixels.data() + 3 * i;
    const bool matt = std::max({albedo[0], albedo[1], albedo[2]}) > 0 && !guides_.metal[i];
    reflects_[i] = guides_.mask[i] && matt ? 1 : 0;
  }
  answer_ = scaled(sum, 1 / static_cast<float>(answers));
}

AnsweredLight Residual::answered() const {
  AnsweredLight out;
  const auto pixels = static_cast<float>(guides_.pixels());
  const int square = std::max(1, static_cast<int>(std::sqrt(pixels / kChecked)));
  Rng rng(kAnswers, 1);
  for (int y = 0; y + square <= guides_.height(); y += square) {
    for (int x = 0; x + square <= guides_.width(); x += square) {
      const int within_x = static_cast<int>(rng.uniform() * static_cast<float>(square));
      const int within_y = static_cast<int>(rng.uniform() * static_cast<float>(square));
      const size_t i = guides_.index(x + within_x, y + within_y);
      if (reflects_[i]) out.add(guides_.position.rgb(i), guides_.normal.rgb(i), answer_.rgb(i));
    }
  }
  return out;
}

bool Residual::step(const SessionState& state, const scene::Camera& camera, RenderSettings settings,
                    StageSeconds* seconds) {
  answer(state, camera, settings);
  const Output output = std::exchange(settings.output, Output::Irradiance);
  settings.mode = Mode::Reference;
  settings.spp = kPaths;
  settings.antialias = 0;
  settings.layers = false;
  settings.seed = static_cast<uint64_t>(paths_) + 1;
  const Image light = state.render(camera, settings, seconds).color;
  const auto which = static_cast<size_t>(paths_ / kPaths) % 2;
  std::array<Image, 2> halves = halves_;
  if (halves[which].width == 0) halves[which] = Image(light.width, light.height, light.channels);
  for (size_t i = 0; i < light.pixels.size(); ++i) halves[which].pixels[i] += light.pixels[i];
  const int paths = paths_ + kPaths;
  const bool corrects = paths > kPaths && std::has_single_bit(static_cast<unsigned>(paths));
  if (corrects) {
    const float mean = 2 * static_cast<float>(kPaths) / static_cast<float>(paths);
    correction_ =
        correction(scaled(halves[0], mean), scaled(halves[1], mean), output, settings.done);
  }
  halves_ = std::move(halves);
  paths_ = paths;
  return corrects;
}

/// What is to be added to a picture of that output, by the means of both halves.
Image Residual::correction(const Image& half_a, const Image& half_b, Output output,
                           const std::function<void(int64_t)>& done) const {
  const auto check = [&] {
    if (done) done(0);
  };
  Image out = correct_by_paths(guides_, reflects_, answer_, half_a, half_b, check);
  for (size_t i = 0; i < out.pixels.size(); ++i) {
    const float reflected = output == Output::Irradiance ? 1 : guides_.albedo.pixels[i] / kPi;
    out.pixels[i] = reflects_[i / 3] ? reflected * (out.pixels[i] - answer_.pixels[i]) : 0;
  }
  return out;
}

void Residual::add_to(Image* picture) const {
  if (correction_.width != picture->width) return;
  for (size_t i = 0; i < picture->pixels.size(); ++i) picture->pixels[i] += correction_.pixels[i];
}

}  // namespace lte::infer::view
