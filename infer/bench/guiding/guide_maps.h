// Maps of radiance that guide paths, predicted or traced, each for itself or shared by neighbours.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "lte/base/text.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/incident/guide.h"
#include "lte/pathtrace/incident/shared_places.h"
#include "lte/pathtrace/lights/lights.h"
#include "lte/runtime/embedding.h"

namespace lte::infer {

/// Points that maps are made at.
struct MapPlaces {
  std::span<const Vec3> position, normal;
  std::span<const Rgb> albedo;

  size_t size() const { return position.size(); }
};

/// The same, as it grows.
struct PlaceList {
  std::vector<Vec3> position, normal;
  std::vector<Rgb> albedo;

  void push_back(const Vec3& the_position, const Vec3& the_normal, const Rgb& the_albedo) {
    position.push_back(the_position);
    normal.push_back(the_normal);
    albedo.push_back(the_albedo);
  }
  MapPlaces view() const { return {position, normal, albedo}; }
};

/// Cosine between the normals of points that share a map.
inline constexpr float kLeastCosine = 0.9f;

/// Paths a cell of maps that are traced.
inline constexpr int kTracedPaths = 4;

/// What a row is called.
inline std::string guide_name(const std::string& what, int bins, const std::string& maps) {
  return concat(what, ", ", bins, " x ", bins, ", ", maps);
}

/// bins × bins cells at each of some places, and how long making them took.
class GuideMaps {
 public:
  /// By the network's radiance decoder, from the middles of the cells.
  static GuideMaps predicted(const runtime::SceneEmbedding& embedding, const MapPlaces& places,
                             int bins);
  /// By paths, so many a cell: direct light and indirect.
  static GuideMaps traced(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                          const MapPlaces& places, int bins, int paths);

  size_t size() const { return normal_.size(); }
  pathtrace::DirectionMap at(size_t place) const;
  double seconds() const { return seconds_; }  ///< of the processor

 private:
  GuideMaps(const MapPlaces& places, int bins);

  int bins_;
  double seconds_ = 0;
  std::vector<Vec3> normal_;
  std::vector<Rgb> radiance_;  ///< [places, cells]
};

/// Guides by maps that several surfaces share: one table for all that is diffuse around a place, one
/// of its own for each view of metal.
class SharedGuides {
 public:
  /// @param maps  of the places; must outlive this
  explicit SharedGuides(const GuideMaps& maps);

  pathtrace::Guide guide(size_t place, const Vec3& normal,
                         const pathtrace::Reflector& reflector) const;
  double seconds() const { return seconds_; }  ///< of the processor, of all places' tables

 private:
  const GuideMaps& maps_;
  std::vector<std::shared_ptr<const pathtrace::GuideTable>> tables_;
  double seconds_ = 0;
};

}  // namespace lte::infer
