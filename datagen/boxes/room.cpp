#include "datagen/boxes/room.h"

#include <algorithm>

#include "datagen/boxes/furniture.h"
#include "datagen/boxes/materials.h"
#include "datagen/common/daylight.h"
#include "datagen/common/parts.h"
#include "lte/base/check.h"
#include "lte/base/random.h"

namespace lte::datagen::boxes {
namespace {

constexpr int kPlaceAttempts = 24;
constexpr float kGap = 0.02f;  // metres between pieces, and between a piece and a wall
constexpr Rgb kWarmestLight{1.0f, 0.75f, 0.50f};
constexpr float kDoorClearance = 0.8f;  // metres kept free on both sides of the doorway
// In the order of quarter turns: where the back of a piece that faces +z comes to lie.
constexpr unsigned kSideFaces[4] = {kNegZ, kNegX, kPosZ, kPosX};

bool overlap(const Bounds& a, const Bounds& b, float margin) {
  for (int axis = 0; axis < 3; ++axis)
    if (a.low[axis] >= b.high[axis] + margin || b.low[axis] >= a.high[axis] + margin) return false;
  return true;
}

Bounds grown(const Bounds& b, const Vec3& by) { return {b.low - by, b.high + by}; }

/// Of the room, through one of its sides.
Vec3 outwards(unsigned side) {
  if (side == kNegX || side == kPosX) return {side == kPosX ? 1.0f : -1.0f, 0, 0};
  return {0, 0, side == kPosZ ? 1.0f : -1.0f};
}

/// Builds one scene, step by step; the order of the steps is the order of the random draws.
class RoomMaker {
 public:
  RoomMaker(const RoomConfig& config, uint64_t seed, Room* room)
      : config_(config),
        rng_(seed, 0x726f6f6dULL),
        sky_rng_(seed, 0x736b79ULL),
        scene_(room->scene),
        plan_(room->plan),
        materials_(&room->scene, config.texture_sizes, seed) {}

  void make() {
    lay_out();
    build_shell();
    const bool open = plan_.missing_walls[0] != 0;
    const bool sky = sky_rng_.uniform() < (open ? config_.sky_share : config_.shut_sky_share);
    if (!sky || !open || sky_rng_.below(2) == 0) place_lights();
    for (int room = 0; room < rooms(); ++room) {
      furnish(room);
      hang_pictures(room);
    }
    resize();
    if (sky) add_daylight();
  }

 private:
  int rooms() const { return static_cast<int>(plan_.rooms.size()); }
  float height() const { return plan_.rooms[0].high.y; }
  float draw(const Range& range) {
    return rng_.uniform(static_cast<float>(range.low), static_cast<float>(range.high));
  }
  int64_t draw(const CountRange& range) {
    return range.low +
           static_cast<int64_t>(rng_.below(static_cast<uint64_t>(range.high - range.low + 1)));
  }

  void lay_out();
  void build_shell();
  void build_partition(int left_wall, int right_wall);
  void place_lights();
  void add_daylight();
  bool place_light(int room);
  void furnish(int room);
  bool place_piece(int room, PieceKind kind);
  Affine try_placement(const Bounds& local, const Bounds& inner, bool at_wall);
  bool is_free(const Bounds& bounds) const;
  void hang_pictures(int room);
  void resize();
  void add(const std::string& name, const std::vector<Part>& parts, const Affine& to_world);

  const RoomConfig& config_;
  Rng rng_;
  Rng sky_rng_;  // of its own: scenes of configurations without skies are what they were
  scene::Scene& scene_;
  RoomPlan& plan_;
  MaterialFactory materials_;
  std::vector<Bounds> taken_;  // new pieces must keep clear of these
};

void RoomMaker::add(const std::string& name, const std::vector<Part>& parts,
                    const Affine& to_world) {
  for (const int mesh : add_meshes(&scene_, name, parts))
    scene_.instances.push_back({mesh, to_world, scene::kNone});
}

void RoomMaker::lay_out() {
  const bool two = rng_.uniform() < config_.two_room_share;
  const float width = draw(config_.width_m), depth = draw(config_.depth_m);
  const float high = draw(config_.height_m);
  plan_.rooms.push_back({{0, 0, 0}, {width, high, depth}});
  plan_.missing_walls.assign(two ? 2 : 1, 0);
  // Nothing is drawn for what a configuration never asks for: its scenes stay the ones they were.
  if (config_.open_share > 0 && rng_.uniform() < config_.open_share)
    for (unsigned& face : plan_.missing_walls)
      face = two ? (rng_.below(2) == 0 ? kNegZ : kPosZ) : kSideFaces[rng_.below(4)];
  if (!two) return;
  const float thickness = rng_.uniform(0.1f, static_cast<float>(kMaxPartitionThickness));
  const float second = draw(config_.width_m);
  plan_.rooms.push_back({{width + thickness, 0, 0}, {width + thickness + second, high, depth}});
  const float opening = rng_.uniform(0.8f, 1.2f), top = rng_.uniform(2.0f, 2.1f);
  const float from = rng_.uniform(0.1f, depth - opening - 0.1f);
  plan_.doorway = {{width, 0, from}, {width + thickness, top, from + opening}};
  taken_.push_back(grown(plan_.doorway, {kDoorClearance, 0, 0}));
}

/// Each room's walls are the inside of a box; two rooms' boxes meet in the middle of the partition,
/// so the shell is closed even if the partition were not there.
void RoomMaker::build_shell() {
  std::vector<int> partition_walls;
  const float middle = rooms() > 1 ? plan_.doorway.center().x : 0;
  for (int r = 0; r < rooms(); ++r) {
    Bounds box = plan_.rooms[static_cast<size_t>(r)];
    unsigned open = 0;
    if (rooms() > 1) {
      (r == 0 ? box.high.x : box.low.x) = middle;
      open = r == 0 ? kPosX : kNegX;
    }
    const int wall = materials_.wall();
    const int accent = rng_.below(3) == 0 ? materials_.wall() : wall;  // one wall of its own color
    const unsigned accent_side = rng_.below(2) == 0 ? kNegZ : kPosZ;
    std::vector<Part> parts{{box.low, box.high, materials_.floor(), kNegY, 0, true},
                            {box.low, box.high, materials_.ceiling(), kPosY, 0, true}};
    const unsigned missing = plan_.missing_walls[static_cast<size_t>(r)];
    if (missing == 0) {
      parts.push_back({box.low, box.high, wall, kSides & ~open & ~accent_side, 0, true});
      parts.push_back({box.low, box.high, accent, accent_side, 0, true});
    } else {
      for (const unsigned side : kSideFaces)
        if ((side & (open | missing)) == 0)
          parts.push_back({box.low, box.high, materials_.wall(), side, 0, true});
    }
    partition_walls.push_back(wall);
    add(concat("shell ", r), parts, {});
  }
  if (rooms() > 1) build_partition(partition_walls[0], partition_walls[1]);
}

void RoomMaker::build_partition(int left_wall, int right_wall) {
  const Bounds& door = plan_.doorway;
  const float depth = plan_.rooms[0].high.z;
  struct Block {
    Bounds box;
    unsigned reveal;  // faces that look into the doorway
  };
  const Block blocks[3] = {
      {{{door.low.x, 0, 0}, {door.high.x, height(), door.low.z}}, kPosZ},
      {{{door.low.x, 0, door.high.z}, {door.high.x, height(), depth}}, kNegZ},
      {{{door.low.x, door.high.y, door.low.z}, {door.high.x, height(), door.high.z}}, kNegY}};
  std::vector<Part> parts;
  for (const Block& block : blocks) {
    Bounds reveal = block.box;
    reveal.high.y = std::min(reveal.high.y, block.reveal == kNegY ? reveal.high.y : door.high.y);
    parts.push_back({block.box.low, block.box.high, left_wall, kNegX, 0, false});
    parts.push_back({block.box.low, block.box.high, right_wall, kPosX, 0, false});
    parts.push_back({reveal.low, reveal.high, materials_.trim(), block.reveal, 0, false});
  }
  add("partition", parts, {});
}

void RoomMaker::place_lights() {
  const int64_t wanted = draw(config_.lights);
  // In one pair of rooms out of four, one is lit through the doorway alone.
  const bool one_dark = rooms() > 1 && rng_.below(4) == 0;
  const int first = rooms() > 1 ? static_cast<int>(rng_.below(2)) : 0;
  int64_t placed = 0;
  for (int64_t i = 0; placed < wanted && i < wanted * kPlaceAttempts; ++i) {
    const int room = rooms() > 1 && !one_dark ? (first + static_cast<int>(placed)) % 2 : first;
    if (place_light(room)) ++placed;
  }
  LTE_CHECK(placed > 0, "no ceiling light fits a room of the configured size");
}

/// Adds a flat housing under the ceiling whose bottom emits. Its sides are dark, its top is the
/// ceiling.
bool RoomMaker::place_light(int room) {
  const Bounds& inner = plan_.rooms[static_cast<size_t>(room)];
  const Vec3 size{rng_.uniform(0.25f, 1.2f), rng_.uniform(0.01f, 0.02f), rng_.uniform(0.25f, 1.2f)};
  const Vec3 span = inner.extent() - size - Vec3{2, 0, 2} * kLightWallDistance;
  const float u = rng_.uniform(), v = rng_.uniform();
  if (span.x < 0 || span.z < 0) return false;
  const Vec3 low{inner.low.x + kLightWallDistance + u * span.x, height() - size.y,
                 inner.low.z + kLightWallDistance + v * span.z};
  const Bounds box{low, {low.x + size.x, height(), low.z + size.z}};
  for (const Bounds& other : plan_.lights)
    if (overlap(box, other, 0.2f)) return false;
  const Rgb tint = light_tint(rng_.uniform(), kWarmestLight);
  const int emitter = materials_.light(tint * log_uniform(config_.radiance, &rng_));

  const std::string name = concat("light ", plan_.lights.size());
  add(name + " frame", {{box.low, box.high, materials_.trim(), kSides, 0, false}}, {});
  const int mesh = add_meshes(&scene_, name, {{box.low, box.high, emitter, kNegY, 0, false}})[0];
  scene_.instances.push_back({mesh, {}, static_cast<int>(scene_.light_groups.size())});
  scene_.light_groups.push_back(name);
  plan_.lights.push_back(box);
  return true;
}

void RoomMaker::add_daylight() {
  const float level = log_uniform(config_.radiance, &sky_rng_) * sky_rng_.uniform(0.025f, 0.25f);
  const Rgb radiance = light_tint(sky_rng_.uniform(0, 0.35f)) * level;
  const bool sunny = sky_rng_.below(2) == 0;
  const unsigned open = plan_.missing_walls[0];
  const unsigned side = open != 0 ? open : kSideFaces[sky_rng_.below(4)];
  Daylight light = daylight(radiance, outwards(side), &sky_rng_);
  if (sunny) add_sun(&light, &sky_rng_, &scene_);
  add_sky(light, config_.sky_picture_share, &sky_rng_, &scene_);
}

bool RoomMaker::is_free(const Bounds& bounds) const {
  for (const Bounds& other : taken_)
    if (overlap(bounds, other, kGap)) return false;
  for (const Bounds& light : plan_.lights) {
    Bounds zone = grown(light, {kLightTallDistance, 0, kLightTallDistance});
    zone.low.y = height() - kLightHeadroom;
    if (overlap(bounds, zone, 0)) return false;
  }
  return true;
}

/// Draws a place inside the room, back to a wall or anywhere. It may still overlap something.
Affine RoomMaker::try_placement(const Bounds& local, const Bounds& inner, bool at_wall) {
  const uint64_t quarter = rng_.below(4);
  const bool turned = !at_wall && rng_.below(2) == 0;
  const double degrees =
      90.0 * static_cast<double>(quarter) + (turned ? 90.0 * rng_.uniform() : 0.0);
  const Bounds box = transformed(local, placement(degrees, {}));
  const Vec3 first = inner.low + Vec3{kGap, 0, kGap} - box.low;
  const Vec3 last = inner.high - Vec3{kGap, 0, kGap} - box.high;
  const float u = rng_.uniform(), v = rng_.uniform();
  Vec3 at{first.x + u * (last.x - first.x), 0, first.z + v * (last.z - first.z)};
  if (at_wall) {  // +z turns towards +x: the back faces −z, −x, +z, +x in turn
    if (quarter == 0) at.z = first.z;
    if (quarter == 1) at.x = first.x;
    if (quarter == 2) at.z = last.z;
    if (quarter == 3) at.x = last.x;
  }
  return placement(degrees, at);
}

bool RoomMaker::place_piece(int room, PieceKind kind) {
  const Bounds& inner = plan_.rooms[static_cast<size_t>(room)];
  Rng piece_rng(rng_.next_u64());
  const Assembly piece = make_piece(kind, height(), &materials_, &piece_rng);
  const Bounds local = piece.bounds();
  for (int attempt = 0; attempt < kPlaceAttempts; ++attempt) {
    const Affine to_world = try_placement(local, inner, stands_at_wall(kind));
    const Bounds bounds = transformed(local, to_world);
    if (bounds.low.x < inner.low.x || bounds.high.x > inner.high.x || bounds.low.z < inner.low.z ||
        bounds.high.z > inner.high.z || !is_free(bounds))
      continue;
    const std::string name = concat("piece ", plan_.furniture.size(), " ", piece.name);
    add(name, piece.parts, to_world);
    plan_.furniture.push_back({name, room, bounds});
    taken_.push_back(bounds);
    return true;
  }
  return false;
}

void RoomMaker::furnish(int room) {
  const int64_t pieces = draw(config_.furniture);
  for (int64_t i = 0; i < pieces; ++i)
    place_piece(room, static_cast<PieceKind>(rng_.below(kPieceKinds)));
}

/// Hangs pictures, thin boxes, on the four walls at eye height, clear of furniture and doorway.
void RoomMaker::hang_pictures(int room) {
  const Bounds& inner = plan_.rooms[static_cast<size_t>(room)];
  const uint64_t pictures = rng_.below(4);
  for (uint64_t i = 0; i < pictures; ++i) {
    const uint64_t quarter = rng_.below(4);
    const bool nowhere = kSideFaces[quarter] == plan_.missing_walls[static_cast<size_t>(room)];
    const float width = rng_.uniform(0.3f, 1.0f), high = rng_.uniform(0.3f, 0.8f);
    const float thickness = rng_.uniform(0.015f, 0.04f), bottom = rng_.uniform(1.0f, 1.4f);
    const float u = rng_.uniform();
    const float wall = quarter % 2 == 0 ? inner.extent().x : inner.extent().z;
    if (nowhere || width + 0.2f > wall || bottom + high > height() - 0.1f) continue;
    const float along = 0.1f + width / 2 + u * (wall - width - 0.2f);
    Vec3 at{inner.low.x + along, bottom, inner.low.z};
    if (quarter == 1) at = {inner.low.x, bottom, inner.low.z + along};
    if (quarter == 2) at.z = inner.high.z;
    if (quarter == 3) at = {inner.high.x, bottom, inner.low.z + along};
    const Part part{{-width / 2, 0, 0},
                    {width / 2, high, thickness},
                    scene::kNone,
                    kAllFaces & ~kNegZ,
                    0,
                    false};
    const Affine to_world = placement(90.0 * static_cast<double>(quarter), at);
    const Bounds bounds = transformed({part.low, part.high}, to_world);
    if (!is_free(bounds)) continue;
    Part canvas = part, frame = part;
    canvas.faces = kPosZ;
    canvas.material = materials_.picture(width, high);
    frame.faces &= ~kPosZ;
    frame.material = materials_.wood();
    const std::string name = concat("piece ", plan_.furniture.size(), " picture");
    add(name, {canvas, frame}, to_world);
    plan_.furniture.push_back({name, room, bounds});
    taken_.push_back(bounds);
  }
}

/// Furniture, lights and their distances keep their proportions: a doll's house, or a hall.
void RoomMaker::resize() {
  if (config_.size_factor.low == 1 && config_.size_factor.high == 1) return;
  const float factor = log_uniform(config_.size_factor, &rng_);
  for (scene::Instance& instance : scene_.instances)
    for (auto& row : instance.to_world.m)
      for (float& element : row) element *= factor;
  const auto scale = [factor](Bounds* bounds) {
    if (bounds->empty()) return;
    bounds->low = bounds->low * factor;
    bounds->high = bounds->high * factor;
  };
  for (Bounds& room : plan_.rooms) scale(&room);
  scale(&plan_.doorway);
  for (PlacedPiece& piece : plan_.furniture) scale(&piece.bounds);
  for (Bounds& light : plan_.lights) scale(&light);
}

}  // namespace

Room generate_room(const RoomConfig& config, uint64_t seed, const std::string& name) {
  Room room;
  room.scene.name = name;
  RoomMaker(config, seed, &room).make();
  return room;
}

}  // namespace lte::datagen::boxes
