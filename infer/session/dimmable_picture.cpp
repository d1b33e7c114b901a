#include "infer/session/dimmable_picture.h"

#include <algorithm>
#include <utility>

#include "infer/session/state.h"
#include "lte/base/check.h"
#include "lte/base/parallel.h"

namespace lte::infer {
namespace {

constexpr int64_t kSumGrain = 1 << 14;

/// The draft with the light of some groups alone, at gain 1.
Draft lit_by(const Draft& draft, const std::vector<int>& groups) {
  Draft out = draft;
  for (size_t g = 0; g < out.settings.size(); ++g) {
    const bool shines =
        std::find(groups.begin(), groups.end(), static_cast<int>(g)) != groups.end();
    out.settings[g].gain = shines ? 1 : 0;
    out.settings[g].color.reset();
  }
  return out;
}

void add_scaled(const image::Image& from, const Rgb& scale, image::Image* to) {
  parallel_for(static_cast<int64_t>(from.pixels.size() / 3), kSumGrain,
               [&](int64_t begin, int64_t end) {
                 for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i) {
                   for (size_t c = 0; c < 3; ++c)
                     to->pixels[3 * i + c] += from.pixels[3 * i + c] * scale[static_cast<int>(c)];
                 }
               });
}

}  // namespace

DimmablePicture::DimmablePicture(const StatePtr& state, const scene::Camera& camera,
                                 RenderSettings settings)
    : made_for_(state) {
  LTE_CHECK(!is_geometry(settings.output), "a picture of ", enum_name(settings.output),
            " has no light that could be dimmed");
  settings.layers = false;
  const SessionState::Parts& parts = state->parts();
  for (const std::vector<int>& groups : partition(*parts.draft)) {
    EditReport ignored;
    auto alone = make_parts(parts.base, std::make_shared<Draft>(lit_by(*parts.draft, groups)),
                            &parts, &ignored);
    // Who answers is decided for the whole picture.
    alone->asks_network = parts.asks_network;
    if (!alone->asks_network) alone->layers.clear();
    layers_.push_back(alone->render(camera, settings, nullptr));
  }
  if (layers_.empty()) layers_.push_back(parts.render(camera, settings, nullptr));  // dark
}

bool DimmablePicture::fits(const SessionState& state) const {
  const SessionState::Parts &a = made_for_->parts(), &b = state.parts();
  return a.base == b.base && a.asks_network == b.asks_network && same_points(*a.draft, *b.draft) &&
         partition(*a.draft) == partition(*b.draft);
}

Frame DimmablePicture::picture(const SessionState& state) const {
  LTE_CHECK(fits(state), "the picture of this state is no sum of the layers that are rendered");
  Frame out = layers_.front();
  std::fill(out.color.pixels.begin(), out.color.pixels.end(), 0.0f);
  const Draft& draft = *state.parts().draft;
  const std::vector<std::vector<int>> groups = partition(draft);
  for (size_t i = 0; i < groups.size(); ++i) {
    const LightSetting& setting = draft.settings[static_cast<size_t>(groups[i].front())];
    add_scaled(layers_[i].color, setting.scale(), &out.color);
  }
  return out;
}

}  // namespace lte::infer
