// --output attention of lte_render: its flags, and what it paints.
#pragma once

#include <optional>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "infer/renderer/attention_map.h"
#include "lte/pathtrace/bvh.h"

namespace lte::infer {

struct RenderRequest;

struct AttentionFlags {
  AttentionChoice choice;
  int head = -1;  ///< -1: the mean over all
};

/// Adds --block and --head.
void add_attention_flags(CLI::App& app, AttentionFlags* flags);

/// @throws lte::Error for flags that do not go together, without --point among them
void check_attention_flags(const RenderRequest& request);

/// What a scene's pictures show of one point.
class AttentionLook {
 public:
  /// @param place   the surface point nearest to it is looked at
  /// @param viewer  from where the point's side is seen
  /// @throws lte::Error naming the flag: a point far from any surface, a block or head that the
  ///         model has not got
  AttentionLook(const AttentionFlags& flags, const Vec3& place, const pathtrace::Bvh& bvh,
                std::shared_ptr<const runtime::SceneEmbedding> recorded, const Vec3& viewer);

  void paint(const scene::Camera& camera, Frame* frame) const;
  nlohmann::json json() const;
  /// A line for people.
  std::string text() const;

 private:
  runtime::SceneAttention inside_;
  AttentionChoice choice_;
  SurfacePoint point_;
  AttentionMap map_;
  std::optional<double> entropy_;  ///< of a block of the encoder
};

}  // namespace lte::infer
