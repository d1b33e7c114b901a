// The appearance of a point on a scene's surfaces.
#pragma once

#include <cstdint>

#include "lte/scene/scene.h"

namespace lte::scene {

/// Metal and roughness at one point, as Material has them, texture included.
struct Gloss {
  float metallic = 0, roughness = 1;
};

/// The appearance of one surface point.
struct Surface {
  Vec3 position;  ///< world
  Vec3 normal;    ///< world, unit, geometric, front side
  Rgb albedo;     ///< [0, 1]
  Rgb emission;   ///< radiance that leaves the front
  Gloss gloss;
  int light_group = kNone;
  bool emits_back = false;
};

/// Evaluates the point (u, v) of a triangle: position = (1 − u − v) p0 + u p1 + v p2.
/// @param footprint  edge in world metres of the square to average textures over; 0 for the finest
///                   level
/// @note A triangle without area gets normal 0.
Surface evaluate_surface(const Scene& scene, int instance, uint32_t triangle, float u, float v,
                         float footprint);

/// Evaluates the appearance alone, which is cheaper: a path needs no more at a hit whose normal
/// Embree gave.
void evaluate_appearance(const Scene& scene, int instance, uint32_t triangle, float u, float v,
                         float footprint, Rgb* albedo, Rgb* emission);

/// Evaluates how metallic and how rough a surface is. It is apart from evaluate_appearance(), as
/// few surfaces are metal at all.
Gloss evaluate_gloss(const Scene& scene, int instance, uint32_t triangle, float u, float v,
                     float footprint);

}  // namespace lte::scene
