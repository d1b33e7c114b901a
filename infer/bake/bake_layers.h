// The light of a bake's layers.
#pragma once

#include <atomic>
#include <future>
#include <memory>
#include <vector>

#include "infer/bake/bake_command.h"
#include "infer/bake/bake_parts.h"
#include "infer/bake/kept_bake.h"
#include "infer/renderer/quality.h"
#include "infer/renderer/renderer.h"
#include "lte/bake/bake.h"
#include "lte/render/integrator.h"

namespace lte::infer {

/// Of an atlas's pixels, how many are texels, about.
inline constexpr double kAtlasUse = 0.7;

/// The passes that a light map of a quality has.
/// @param texels  of the light map, about
bake::LightOptions quality_options(Quality quality, double texels);

/// Texels of the light map that is asked for, about: what is known before charts are made.
double expected_texels(const BakeRequest& request, const scene::Scene& scene);

/// The integrator of all light, which is prepared while charts are made: neither needs the other.
/// With a network, whose places are texels, get() prepares it. Borrows all that it is made of.
class PreparedIntegrator {
 public:
  PreparedIntegrator(const BakeRequest& request, const render::TracedScene& scene);
  ~PreparedIntegrator();
  PreparedIntegrator(const PreparedIntegrator&) = delete;
  PreparedIntegrator& operator=(const PreparedIntegrator&) = delete;

  /// Once. @param source  of the network; empty without one
  std::unique_ptr<render::Integrator> get(const render::IrradianceSource& source);

 private:
  const BakeRequest& request_;
  const render::TracedScene scene_;
  std::atomic<bool> dropped_{false};
  std::future<std::unique_ptr<render::Integrator>> made_;
};

/// A bake that goes on from an earlier one.
struct SinceBake {
  const KeptBake& old;
  const bake::Relayout& relayout;
  bake::Kept kept;  ///< what bake_layers() has found
};

/// One layer of all light, or with --by-light one a light group.
/// @param network  that fills caches; null: paths trace them
/// @param prepared of the scene
/// @param seconds  since the work began, of which --time leaves the rest
/// @param parts    where --resume finds what was sampled, and a --shard leaves it; null: nowhere
/// @param since    null: all is baked
/// @param state    gets the samples of the only layer; may be null
/// @return  nothing of a --shard
std::vector<bake::BakedLayer> bake_layers(const BakeRequest& request,
                                          const runtime::Network* network,
                                          const EmbedSettings& settings, const bake::Layout& layout,
                                          PreparedIntegrator* prepared, double seconds,
                                          const BakeParts* parts, SinceBake* since,
                                          bake::LightState* state, Renderer* renderer);

}  // namespace lte::infer
