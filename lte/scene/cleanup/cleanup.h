// What is wrong with a scene's geometry, counted, and what of it can be put right.
#pragma once

#include <cstdint>
#include <string>

#include "lte/scene/scene.h"

namespace lte::scene {

/// What to put right. Everything is off unless asked for: a scene is rendered as the file has it.
struct CleanupOptions {
  bool degenerate = false;  ///< remove triangles without area
  bool duplicates = false;  ///< of coincident triangles of one material and winding keep the first
  bool shells = false;      ///< the same for either winding and any material; emitters stay
  bool vertices = false;    ///< move near-duplicate vertices of a mesh onto each other
  bool meshes = false;      ///< store meshes that are alike but for a translation once
  /// How near vertices are near-duplicates, as a share of the scene's diagonal.
  double tolerance = 1e-6;

  bool any() const { return degenerate || duplicates || shells || vertices || meshes; }
};

/// Reads "degenerate,duplicates,shells,vertices,meshes" or a part of it, "all" or "none".
/// @throws lte::Error naming the word that is none of them.
CleanupOptions parse_cleanup(const std::string& list);

/// Counts over all instances of the scene as it was found. A shell is a surface connected through
/// its edges; it is closed if two triangles, wound alike, meet at each of them.
struct CleanupReport {
  bool inspected = true;  ///< false for scenes of more instanced triangles than kMaxInspected
  int64_t degenerate_triangles = 0;   ///< thinner than 1e-7 of their longest edge: without a normal
  int64_t duplicate_triangles = 0;    ///< beyond the first: same places, material and winding
  int64_t opposite_triangles = 0;     ///< beyond the first: same places and material, other winding
  int64_t conflicting_triangles = 0;  ///< beyond the first: same places, other material
  int64_t near_duplicate_vertices = 0;
  int64_t duplicate_meshes = 0;  ///< beyond the first
  int64_t open_edges = 0;        ///< of one triangle alone: light may leak there
  double open_edge_length_m = 0;
  int64_t branching_edges = 0;  ///< of three triangles or more
  int64_t flipped_edges = 0;    ///< between two triangles that are wound against each other
  int64_t closed_shells = 0;    ///< without an open, branching or flipped edge
  int64_t inward_shells = 0;    ///< closed ones whose front is inside: rooms are, furniture is not
  int64_t removed_triangles = 0;  ///< by clean_up()
};

inline constexpr int64_t kMaxInspected = 64'000'000;

/// Counts, and changes nothing.
CleanupReport inspect(const Scene& scene, double tolerance = CleanupOptions{}.tolerance);

/// Counts, then does what `options` asks for. Instances that lose all their triangles go, and so do
/// light groups without an emitter. A shared mesh is copied for an instance that loses other
/// triangles than its peers.
CleanupReport clean_up(Scene* scene, const CleanupOptions& options);

}  // namespace lte::scene
