#include "lte/pathtrace/reach/lost_light.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>

#include "lte/base/log.h"
#include "lte/base/random.h"
#include "lte/base/text.h"
#include "lte/pathtrace/hemisphere.h"
#include "lte/pathtrace/ray_offset.h"
#include "lte/scene/area_table.h"
#include "lte/scene/surface.h"

namespace lte::pathtrace {
namespace {

constexpr int kRays = 256;
constexpr int kEnough = 8;            ///< rays that get away
constexpr int kNearAMeeting = 10;     ///< rays that end nearby, for each that gets away: enclosed
constexpr double kNearbyShare = 0.1;  ///< of the edge of a square of the lamp's area
constexpr double kGolden = 0.6180339887498949;  ///< its multiples are spread evenly over [0, 1)
constexpr size_t kMaxNames = 4;

enum class Fate { Reaches, Misses, Enclosed };

/// Where the rays of one luminaire end.
class RayCount {
 public:
  RayCount(const Bvh& bvh, float nearby) : bvh_(bvh), nearby_(nearby) {}

  bool decided() const { return far_ >= kEnough; }
  void cast(const Vec3& origin, const Vec3& direction, float reach = INFINITY) {
    ++cast_;
    const Hit hit = bvh_.intersect({origin, direction, 0, reach});
    if (hit.valid()) ++(hit.t > nearby_ ? far_ : near_);
  }
  Fate fate() const {
    if (cast_ == 0) return Fate::Reaches;  // it is black
    if (near_ + far_ == 0) return Fate::Misses;
    return near_ >= kNearAMeeting * std::max(far_, 1) ? Fate::Enclosed : Fate::Reaches;
  }

 private:
  const Bvh& bvh_;
  float nearby_;
  int cast_ = 0, near_ = 0, far_ = 0;
};

Fate fate_of_surfaces(const Bvh& bvh, int group, const std::vector<int>& instances) {
  const scene::Scene& scene = bvh.scene();
  const scene::AreaTable table(scene, scene::fronts(instances));
  if (!(table.total() > 0)) return Fate::Reaches;
  const float magnitude = 0.5f * max_component(bvh.bounds().extent());
  RayCount rays(bvh, static_cast<float>(kNearbyShare * std::sqrt(table.total())));
  for (int i = 0; i < kRays && !rays.decided(); ++i) {
    Rng rng(static_cast<uint64_t>(group), static_cast<uint64_t>(i));
    const scene::AreaTable::Place place = table.locate(std::fmod(i * kGolden, 1.0) * table.total());
    float u = rng.uniform(), v = rng.uniform();
    if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    const scene::Surface lamp =
        scene::evaluate_surface(scene, place.face.instance, place.triangle, u, v, 0);
    if (!(max_component(lamp.emission) > 0)) continue;
    const bool back = lamp.emits_back && rng.uniform() < 0.5f;
    const Vec3 side = back ? lamp.normal * -1.0f : lamp.normal;
    float pdf;
    const Vec3 direction = cosine_direction(side, {rng.uniform(), rng.uniform()}, &pdf);
    rays.cast(offset_origin(lamp.position, side, magnitude), direction);
  }
  return rays.fate();
}

/// Uniform over the cone of a spot, or over all directions.
Fate fate_of_light(const Bvh& bvh, int group, const scene::PunctualLight& light) {
  if (!(max_component(light.intensity) > 0)) return Fate::Reaches;
  const bool spot = light.kind == scene::LightKind::Spot;
  const float widest = spot ? std::cos(light.outer_cone) : -1.0f;
  const Vec3 axis = spot ? light.direction : Vec3{0, 0, 1};
  Vec3 tangent, bitangent;
  make_frame(axis, &tangent, &bitangent);
  RayCount rays(bvh, 0);
  for (int i = 0; i < kRays && !rays.decided(); ++i) {
    Rng rng(static_cast<uint64_t>(group), static_cast<uint64_t>(i));
    const float cosine = 1 - (1 - widest) * rng.uniform();
    const float sine = std::sqrt(std::max(0.0f, 1 - cosine * cosine));
    const Vec2 around = unit_circle(rng.uniform());
    rays.cast(light.position,
              axis * cosine + tangent * (sine * around.x) + bitangent * (sine * around.y),
              light.range);
  }
  return rays.fate();
}

std::string names_of(const scene::Scene& scene, std::span<const int> groups) {
  std::string names;
  for (size_t i = 0; i < std::min(groups.size(), kMaxNames); ++i)
    names += concat(i == 0 ? "" : ", ", quote(scene.light_groups[static_cast<size_t>(groups[i])]));
  if (groups.size() > kMaxNames) names += concat(" and ", groups.size() - kMaxNames, " more");
  return names;
}

/// @param loss  what follows the names, as in "no light to any surface"
void warn(const std::string& scene, const Bvh& bvh, const std::vector<int>& groups,
          const char* loss) {
  if (groups.empty()) return;
  const bool one = groups.size() == 1;
  log_warning(scene, ": ", one ? "lamp " : "lamps ", names_of(bvh.scene(), groups),
              one ? " sends " : " send ", loss,
              ". A surface shines from its front, where its vertices run counter-clockwise: turn "
              "it, or let its material emit from both sides (glTF: doubleSided)");
}

}  // namespace

LostLight find_lost_light(const Bvh& bvh) {
  const scene::Scene& scene = bvh.scene();
  std::map<int, std::vector<int>> surfaces;
  for (size_t i = 0; i < scene.instances.size(); ++i) {
    const scene::Instance& instance = scene.instances[i];
    const int material = scene.meshes[static_cast<size_t>(instance.mesh)].material;
    if (instance.light_group != scene::kNone &&
        scene.materials[static_cast<size_t>(material)].emissive())
      surfaces[instance.light_group].push_back(static_cast<int>(i));
  }
  std::vector<Fate> fates(scene.light_groups.size(), Fate::Reaches);
  for (const auto& [group, instances] : surfaces)
    fates[static_cast<size_t>(group)] = fate_of_surfaces(bvh, group, instances);
  for (const scene::PunctualLight& light : scene.lights) {
    if (light.light_group == scene::kNone || light.kind == scene::LightKind::Directional) continue;
    fates[static_cast<size_t>(light.light_group)] = fate_of_light(bvh, light.light_group, light);
  }
  LostLight lost;
  for (size_t group = 0; group < fates.size(); ++group) {
    if (fates[group] == Fate::Misses) lost.missing.push_back(static_cast<int>(group));
    if (fates[group] == Fate::Enclosed) lost.enclosed.push_back(static_cast<int>(group));
  }
  return lost;
}

void warn_of_lost_light(const std::string& scene, const Bvh& bvh) {
  const LostLight lost = find_lost_light(bvh);
  warn(scene, bvh, lost.missing, "no light to any surface (facing away?)");
  warn(scene, bvh, lost.enclosed, "light no further than to a surface at the lamp (facing it?)");
}

}  // namespace lte::pathtrace
