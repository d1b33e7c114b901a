#include "infer/session/dimmable_picture.h"

#include <algorithm>
#include <utility>

#include "lte/base/check.h"
#include "lte/base/parallel_each.h"

namespace lte::infer {
namespace {

constexpr int64_t kSumGrain = 1 << 14;

/// The edits with the light of some groups alone, at gain 1.
std::shared_ptr<const SceneEdits> lit_by(const SceneEdits& edits, const std::vector<int>& groups) {
  auto out = std::make_shared<SceneEdits>(edits);
  for (size_t g = 0; g < out->settings.size(); ++g) {
    const bool shines =
        std::find(groups.begin(), groups.end(), static_cast<int>(g)) != groups.end();
    out->settings[g].gain = shines ? 1 : 0;
    out->settings[g].color.reset();
  }
  return out;
}

/// What the network makes of the light of some groups; null if it reads none of it.
std::shared_ptr<const LightLayer> encoding_of(const SessionState::Parts& state,
                                              const std::vector<int>& groups) {
  for (const ScaledLayer& each : state.layers) {
    for (const int group : groups) {
      const int light = state.edits->settings[static_cast<size_t>(group)].label.id;
      if (std::ranges::count(each.layer->lights, light) > 0) return each.layer;
    }
  }
  return nullptr;
}

/// A state with the light of some groups alone.
std::shared_ptr<const SessionState::Parts> layer_alone(const SessionState::Parts& state,
                                                       const std::vector<int>& groups) {
  auto alone = std::make_shared<SessionState::Parts>();
  alone->base = state.base;
  alone->edits = lit_by(*state.edits, groups);
  EditReport ignored;
  const Traced traced = trace(*alone->base, *alone->edits, /*lit=*/true, &ignored);
  alone->scene = traced.scene;
  alone->bvh = traced.bvh;
  alone->lights = traced.lights;
  alone->asks_network = state.asks_network;  // decided for the whole picture
  if (auto encoding = encoding_of(state, groups)) alone->layers = {{std::move(encoding)}};
  alone->answered_by = state.answered_by;
  alone->records = state.records;
  if (alone->records) alone->cache = alone->make_cache();
  return alone;
}

void add_scaled(const image::Image& from, const Rgb& scale, image::Image* to) {
  if (to->width == 0) *to = image::Image(from.width, from.height, from.channels);
  parallel_each(from.pixels.size() / 3, kSumGrain, [&](size_t i) {
    for (size_t c = 0; c < 3; ++c)
      to->pixels[3 * i + c] += from.pixels[3 * i + c] * scale[static_cast<int>(c)];
  });
}

image::Image mean_of(const image::Image& sum, int count) {
  image::Image out = sum;
  const float scale = 1 / static_cast<float>(count);
  for (float& value : out.pixels) value *= scale;
  return out;
}

bool same_layers(const std::vector<ScaledLayer>& a, const std::vector<ScaledLayer>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const ScaledLayer& s, const ScaledLayer& t) { return s.layer == t.layer; });
}

}  // namespace

DimmablePicture::DimmablePicture(StatePtr state, Output output, int64_t pixels)
    : made_for_(std::move(state)), output_(output) {
  const SessionState::Parts& parts = made_for_->parts();
  const std::vector<LightGroups> groups = layers_apart(*parts.edits);
  const int64_t bytes = scene_bytes(*parts.scene) + 2 * pixels * int64_t{sizeof(Rgb)};
  apart_ = !render::is_geometry(output) && parts.accuracy == Accuracy::Full && !groups.empty() &&
           std::ssize(groups) * bytes <= kMaxBytes;
  if (!apart_) {
    // The state keeps its parts.
    layers_.push_back({std::shared_ptr<const SessionState::Parts>(made_for_, &parts), 0, {}});
    return;
  }
  for (const LightGroups& each : groups)
    layers_.push_back({layer_alone(parts, each.groups), each.groups.front(), {}});
}

bool DimmablePicture::fits(const SessionState& state) const {
  if (!apart_) return state.version() == made_for_->version();
  const SessionState::Parts &a = made_for_->parts(), &b = state.parts();
  return a.base == b.base && a.asks_network == b.asks_network && a.answered_by == b.answered_by &&
         a.records == b.records && b.accuracy == Accuracy::Full &&
         same_points(*a.edits, *b.edits) && layers_apart(*a.edits) == layers_apart(*b.edits) &&
         same_layers(a.layers, b.layers);
}

void DimmablePicture::add(const scene::Camera& camera, RenderSettings settings, bool anew,
                          StageSeconds* seconds) {
  LTE_CHECK(settings.output == output_, "a picture of another output than the sum's");
  settings.light_samples = std::max(1, settings.light_samples / layers());
  settings.path_samples = std::max(1, settings.path_samples / layers());
  settings.gather_rays = std::max(1, settings.gather_rays / layers());
  while (unfinished_.size() < layers_.size()) {
    StageSeconds part;
    unfinished_.push_back(layers_[unfinished_.size()].alone->render(camera, settings, &part));
    for (const Stage& stage : kStages) unfinished_seconds_.*stage.seconds += part.*stage.seconds;
  }
  std::vector<Frame> frames = std::exchange(unfinished_, {});
  *seconds = std::exchange(unfinished_seconds_, {});
  if (anew) clear();
  for (size_t i = 0; i < layers_.size(); ++i) {
    if (pictures_ == 0) {
      layers_[i].sum = std::move(frames[i].color);
    } else {
      add_scaled(frames[i].color, {1, 1, 1}, &layers_[i].sum);
    }
    layers_[i].clean = {};
  }
  if (!render::is_geometry(output_)) {
    if (pictures_ == 0) albedo_ = normal_ = {};
    add_scaled(frames.front().albedo, {1, 1, 1}, &albedo_);
    add_scaled(frames.front().normal, {1, 1, 1}, &normal_);
  }
  depth_ = std::move(frames.front().depth);
  ++pictures_;
}

void DimmablePicture::denoise(image::OidnQuality quality) {
  const image::Denoiser& denoiser = made_for_->parts().base->denoiser->get();
  if (render::is_geometry(output_) || !denoiser.is_oidn() || pictures_ == 0) return;
  if (layers_.front().clean.width > 0) return;
  const image::Image albedo = mean_of(albedo_, pictures_), normal = mean_of(normal_, pictures_);
  const bool textured = output_ != Output::Irradiance;
  for (Layer& layer : layers_) {
    const image::Image noisy = mean_of(layer.sum, pictures_);
    layer.clean = denoiser.denoise(
        {&noisy, &normal, nullptr, textured ? &albedo : nullptr, nullptr}, quality);
    for (size_t i = 0; i < noisy.pixels.size() / 3; ++i) {
      if (normal.rgb(i) == Vec3{}) layer.clean.set_rgb(i, noisy.rgb(i));  // the sky
    }
  }
}

void DimmablePicture::clear() {
  pictures_ = 0;
  unfinished_.clear();
  unfinished_seconds_ = {};
}

image::Image DimmablePicture::color(const SessionState& state) const {
  LTE_CHECK(fits(state), "the picture of this state is no sum of the layers that are rendered");
  LTE_CHECK(pictures_ > 0, "nothing has been rendered yet");
  const float mean = 1 / static_cast<float>(pictures_);
  image::Image out;
  for (const Layer& layer : layers_) {
    const auto& settings = state.parts().edits->settings;
    const Rgb gain = apart_ ? settings[static_cast<size_t>(layer.group)].scale() : Rgb{1, 1, 1};
    const bool clean = layer.clean.width > 0;
    add_scaled(clean ? layer.clean : layer.sum, clean ? gain : gain * mean, &out);
  }
  return out;
}

}  // namespace lte::infer
