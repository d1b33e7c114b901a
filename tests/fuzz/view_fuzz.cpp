// What a page says to lte_view: a text a line, one conversation an input.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "infer/view/conversation.h"
#include "lte/base/check.h"

namespace {

using namespace lte::infer::view;

bool finite(const lte::Vec3& v) { return lte::is_finite(v); }

bool is_way(const lte::Vec3& v) { return finite(v) && lte::length(v) > 0; }

/// What the threads behind rely on; anything else is a finding.
bool is_sound(const Message& message) {
  if (message.number < 1) return false;
  if (const auto* move = std::get_if<MoveCamera>(&message.request)) {
    const lte::scene::Camera& c = move->camera;
    return finite(c.origin) && finite(c.target) && finite(c.up) && c.vfov >= 1 && c.vfov <= 170;
  }
  if (const auto* view = std::get_if<ChangeView>(&message.request)) {
    if (view->ev && !std::isfinite(*view->ev)) return false;
    return !view->size || (view->size->width >= kMinSide && view->size->width <= kMaxSide &&
                           view->size->height >= kMinSide && view->size->height <= kMaxSide);
  }
  if (const auto* copy = std::get_if<CopyObject>(&message.request))
    return copy->object >= 0 && finite(copy->move);
  if (const auto* lamp = std::get_if<AddLamp>(&message.request))
    return finite(lamp->position) && is_way(lamp->direction) &&
           (!lamp->intensity || (finite(*lamp->intensity) && lamp->intensity->x >= 0));
  const auto* edit = std::get_if<MakeEdit>(&message.request);
  if (edit == nullptr) return true;
  if (const auto* light = std::get_if<LightSetting>(&edit->edit))
    return light->light >= 0 && light->gain >= 0 && std::isfinite(light->gain) &&
           finite(light->color) && (!light->position || finite(*light->position)) &&
           (!light->direction || is_way(*light->direction));
  if (const auto* material = std::get_if<MaterialSetting>(&edit->edit))
    return material->material >= 0 && finite(material->albedo);
  const auto& object = std::get<ObjectSetting>(edit->edit);
  return object.object >= 0 && finite(object.placement.move) && object.placement.scale > 0;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  std::string_view left(reinterpret_cast<const char*>(data), size);
  Conversation conversation;
  while (!left.empty() && !conversation.over()) {
    const std::string_view line = left.substr(0, left.find('\n'));
    left.remove_prefix(std::min(left.size(), line.size() + 1));
    try {
      if (!is_sound(conversation.next(line))) std::abort();
    } catch (const lte::Error& error) {
      const std::string_view what = error.what();
      if (what.empty() || what.size() > 300 || what.find('\n') != what.npos) std::abort();
    }
  }
  return 0;
}
