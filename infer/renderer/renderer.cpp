#include "infer/renderer/renderer.h"

#include <utility>

#include "infer/light/lit_samples.h"
#include "infer/light/untrained_light.h"
#include "infer/renderer/picture_job.h"
#include "lte/base/check.h"
#include "lte/base/timer.h"

namespace lte::infer {

Renderer::Renderer(const scene::Scene& scene)
    : Renderer(std::make_shared<pathtrace::Bvh>(scene), std::make_shared<pathtrace::Lights>(scene),
               std::make_shared<SharedDenoiser>()) {}

Renderer::Renderer(std::shared_ptr<const pathtrace::Bvh> bvh,
                   std::shared_ptr<const pathtrace::Lights> lights,
                   std::shared_ptr<SharedDenoiser> denoiser)
    : held_bvh_(std::move(bvh)),
      held_lights_(std::move(lights)),
      bvh_(*held_bvh_),
      lights_(*held_lights_),
      denoiser_(std::move(denoiser)) {}

void Renderer::embed(const runtime::Network& network, const EmbedSettings& settings) {
  draws_.clear();  // those of before and the new ones would need twice the memory
  seconds_.sample = seconds_.light = seconds_.encode = 0;
  pruned_points_ = {};
  left_out_ = settings.prunes(network) ? settings.unreached : std::vector<int>();
  EmbedSettings draw = settings;
  for (int k = 0; k < settings.draws; ++k, ++draw.seed) draws_.add(encode(network, draw));
}

std::shared_ptr<const runtime::SceneEmbedding> Renderer::encode(const runtime::Network& network,
                                                                const EmbedSettings& settings) {
  Timer timer;
  const int64_t count =
      settings.scene_points > 0 ? settings.scene_points : network.metadata().scene_points;
  pathtrace::PruneCounts pruned;
  scene::SurfaceSamples samples = sample_scene_points(bvh_, count, settings.prunes(network),
                                                      settings.seed, &pruned, {}, left_out_);
  pruned_points_.drawn += pruned.drawn;
  pruned_points_.pruned += pruned.pruned;
  leave_out_untrained_suns(bvh_.scene(), network.metadata(), &samples, left_out_);
  seconds_.sample += timer.seconds();
  timer.restart();
  LitSamples lit = add_light_estimates(bvh_, lights_, std::move(samples), network.light_request(),
                                       settings.seed, left_out_);
  solve_traced_lights(bvh_, lights_, network.config(), settings.seed, left_out_, &lit);
  seconds_.light += timer.seconds();
  timer.restart();
  auto embedding = std::make_shared<const runtime::SceneEmbedding>(
      network, lit.points(),
      runtime::EncodeOptions{settings.rescale, {}, settings.memory, settings.record_attention});
  seconds_.encode += timer.seconds();
  return embedding;
}

void Renderer::make_table(const TableSettings& settings) {
  const Timer timer;
  table_.reset();  // two at a time would need twice the memory
  kept_.reset();
  table_ =
      std::make_shared<const gi::RadiosityTable>(make_light_table(bvh_, lights_, draws_, settings));
  seconds_.table = timer.seconds();
}

void Renderer::set_table(std::shared_ptr<const gi::RadiosityTable> table) {
  table_ = std::move(table);
  kept_.reset();
}

const gi::RadiosityTable& Renderer::table() const {
  LTE_CHECK(table_ != nullptr, "there is no table of light: make_table() comes first");
  return *table_;
}

void Renderer::set_embedding(runtime::SceneEmbedding embedding) {
  set_embedding(std::make_shared<const runtime::SceneEmbedding>(std::move(embedding)));
}

void Renderer::set_embedding(std::shared_ptr<const runtime::SceneEmbedding> embedding) {
  pruned_points_ = {};
  left_out_.clear();
  draws_.clear();
  draws_.add(std::move(embedding));
}

PictureNeeds Renderer::needs(const RenderSettings& settings) const {
  return needs_of(settings, has_light());
}

Frame Renderer::render(const scene::Camera& camera, const RenderSettings& settings) {
  const PictureNeeds needs = this->needs(settings);
  if (needs.keeps_light && !kept_) kept_.emplace();
  PictureJob job({bvh_, lights_, draws_, table_.get(), kept_ ? &*kept_ : nullptr, *denoiser_},
                 camera, settings, needs);
  Frame frame = job.render();
  for (double StageSeconds::*stage : kPictureStages) seconds_.*stage = job.seconds().*stage;
  denoised_by_ = job.denoised_by();
  return frame;
}

}  // namespace lte::infer
