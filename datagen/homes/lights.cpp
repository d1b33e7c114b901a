#include "datagen/homes/lights.h"

#include <algorithm>

#include "datagen/common/daylight.h"

namespace lte::datagen::homes {
namespace {

/// A housing of 1 to 2 cm whose bottom emits. The ceiling closes its top.
void add_panel(Stage* stage, Kit* kit, const Bounds& box, bool on) {
  Piece piece;
  piece.name = "ceiling light";
  const Vec3 lo = box.low, size = box.extent();
  const int trim = kit->palette->trim();
  const Vec3 x{size.x, 0, 0}, y{0, size.y, 0}, z{0, 0, size.z};
  piece.add(panel(lo, z, y), trim, {}, false);           // towards −x
  piece.add(panel(lo + x + z, -z, y), trim, {}, false);  // +x
  piece.add(panel(lo + x, -x, y), trim, {}, false);      // −z
  piece.add(panel(lo + z, x, y), trim, {}, false);       // +z
  const Rgb radiance = light_tint(kit->draw(0, 0.9f)) * (kit->radiance * kit->draw(0.7f, 1.3f));
  const int face = on ? kit->palette->emitter("ceiling light", radiance) : kit->palette->paper();
  piece.add(panel(lo, x, z), face, {}, false);
  stage->plan().ceiling_lights.push_back(box);
  stage->build(std::move(piece));
}

/// A small round fitting with a punctual light under it.
void add_spot(Stage* stage, Kit* kit, const Vec3& at) {
  Piece spot;
  spot.name = "spot";
  kit->turned(&spot,
              {{0, -0.03f}, {0.03f, -0.03f}, {0.045f, -0.022f}, {0.045f, -0.0005f}, {0, -0.0005f}},
              kit->palette->metal(), at, false, 1);
  const float power = kPi * kit->radiance * 0.36f * kit->draw(0.2f, 0.4f);
  spot.point_lights.push_back(
      {at - Vec3{0, 0.06f, 0}, light_tint(kit->draw(0.3f, 0.9f)) * (power / (4 * kPi))});
  stage->build(std::move(spot));
}

void light_room(Stage* stage, Kit* kit, int room, bool on) {
  const FloorPlan& plan = stage->plan().floor;
  const PlanRoom& r = plan.rooms[static_cast<size_t>(room)];
  const bool along_x = r.inner.width() >= r.inner.depth();
  const float length = std::max(r.inner.width(), r.inner.depth()),
              breadth = std::min(r.inner.width(), r.inner.depth());
  const int lights = length > 4.2f ? kit->count(1, 2) : 1;
  const float long_free = length / static_cast<float>(lights) - 2 * kLightWallDistance,
              short_free = breadth - 2 * kLightWallDistance;
  const float a = std::min(kit->draw(0.3f, 1.2f), long_free),
              b = std::min(kit->draw(0.25f, 0.6f), short_free), thick = kit->draw(0.01f, 0.02f);
  // Near the middle of its share of the ceiling.
  const float shift_a = kit->draw(-0.15f, 0.15f) * (long_free - a),
              shift_b = kit->draw(-0.15f, 0.15f) * (short_free - b);
  if (r.type == RoomType::Corridor && kit->chance(0.4f) && on) {
    const float y = plan.height;
    for (const float t : {0.3f, 0.7f}) {
      const Vec3 at = along_x ? Vec3{r.inner.x0 + t * length, y, r.inner.z0 + breadth / 2}
                              : Vec3{r.inner.x0 + breadth / 2, y, r.inner.z0 + t * length};
      add_spot(stage, kit, at);
    }
    return;
  }
  for (int i = 0; i < lights; ++i) {
    const float t = (static_cast<float>(i) + 0.5f) * length / static_cast<float>(lights) + shift_a,
                s = breadth / 2 + shift_b;
    const Vec3 middle{r.inner.x0 + (along_x ? t : s), plan.height, r.inner.z0 + (along_x ? s : t)};
    const Vec3 half{(along_x ? a : b) / 2, 0, (along_x ? b : a) / 2};
    Bounds box{middle - half, middle + half};
    box.low.y = plan.height - thick;
    add_panel(stage, kit, box, on);
  }
}

}  // namespace

void place_ceiling_lights(Stage* stage, Kit* kit, bool daylight) {
  const int rooms = static_cast<int>(stage->plan().floor.rooms.size());
  const int always = kit->count(0, rooms - 1);
  for (int room = 0; room < rooms; ++room)
    light_room(stage, kit, room,
               kit->chance(daylight ? 0.6f : 0.92f) || (room == always && !daylight) ||
                   (rooms == 1 && kit->chance(0.5f)));
}

}  // namespace lte::datagen::homes
