// Normals that a normal map bends.
//
// They say how a surface reflects: the cosine of its light, and the frame of its highlight. Where a
// surface is, and which side of it light reaches, is for the geometric normal. Scene points, and
// with them networks, know the latter alone.
#pragma once

#include <cstdint>

#include "lte/scene/scene.h"

namespace lte::scene {

/// Whether shading_normal() of an instance's points differs from the geometric one.
bool has_normal_map(const Scene& scene, const Instance& instance);

/// The front's unit normal at the point (u, v) of a triangle of an instance that has_normal_map().
///
/// The map bends the mesh's normals where it has them, else the geometric one. Its x axis is the
/// mesh's tangent, else the direction in which the map's U grows over the triangle. A triangle
/// whose UV say no direction keeps its normal. Code 128 of an 8-bit texel counts as 0 in x and y,
/// so that a map of (128, 128, 255) changes nothing.
/// @param footprint  as evaluate_surface() has it
/// @param front      unit, geometric, world
Vec3 shading_normal(const Scene& scene, int instance, uint32_t triangle, float u, float v,
                    float footprint, const Vec3& front);

}  // namespace lte::scene
