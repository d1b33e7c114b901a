#include "infer/render/attention_flags.h"

#include <utility>

#include "infer/render/render_request.h"
#include "lte/base/check.h"

namespace lte::infer {
namespace {

SurfacePoint point_of(const Vec3& at, const pathtrace::Bvh& bvh, const Vec3& viewer) {
  const float reach = pointing_reach(bvh.bounds());
  const std::optional<SurfacePoint> found = surface_near(bvh.scene(), at, reach);
  LTE_CHECK(found.has_value(), "--point ", at.x, ",", at.y, ",", at.z,
            ": there is no surface within ", reach, " m of it");
  return found->facing(viewer);
}

}  // namespace

void add_attention_flags(CLI::App& app, AttentionFlags* flags) {
  app.add_option("--block", flags->choice.block,
                 "With --output attention: decoder (how much each latent counts in the answer at "
                 "the point), decoder.L for one of its layers, or a block of the encoder such as "
                 "down0.0 (what the latent at the point attends to)")
      ->capture_default_str();
  app.add_option("--head", flags->head,
                 "With --output attention: a head of the encoder's block, from 0; by default the "
                 "mean over all")
      ->check(CLI::Range(0, 1 << 20));
}

void check_attention_flags(const RenderRequest& request) {
  const AttentionFlags& flags = request.attention;
  if (request.output != "attention") {
    LTE_CHECK(request.point.empty() || request.output == "incident",
              "--point needs --output attention or incident");
    LTE_CHECK(flags.head < 0 && flags.choice.block == AttentionChoice().block,
              "--block and --head need --output attention");
    return;
  }
  LTE_CHECK(!request.point.empty(),
            "--output attention needs --point X,Y,Z: a point on or near a surface");
  LTE_CHECK(request.mode == "neural",
            "--output attention needs --mode neural: paths attend to "
            "nothing");
  LTE_CHECK(request.embedding.load.empty(),
            "--output attention and --embedding: a file of latents does not hold what the encoder "
            "attended to");
  LTE_CHECK(request.embedding.draws == 1,
            "--output attention and --draws: it shows what one embedding attends to");
  LTE_CHECK(!request.edit.any(), "--output attention and --edit do not go together");
}

AttentionLook::AttentionLook(const AttentionFlags& flags, const Vec3& place,
                             const pathtrace::Bvh& bvh,
                             std::shared_ptr<const runtime::SceneEmbedding> recorded,
                             const Vec3& viewer)
    : inside_(std::move(recorded)), choice_(flags.choice), point_(point_of(place, bvh, viewer)) {
  if (flags.head >= 0) choice_.head = flags.head;
  try {
    map_ = attention_map(inside_, point_, choice_);
  } catch (const Error& error) {
    throw Error(concat("--block ", choice_.block,
                       flags.head >= 0 ? concat(" --head ", flags.head) : "", ": ", error.what()));
  }
  if (!reads_decoder(choice_)) entropy_ = inside_.entropy(find_block(inside_, choice_.block));
}

void AttentionLook::paint(const scene::Camera& camera, Frame* frame) const {
  paint_attention(inside_, map_, point_.position, camera, frame);
}

nlohmann::json AttentionLook::json() const {
  const auto vector = [](const Vec3& v) { return nlohmann::json{v.x, v.y, v.z}; };
  nlohmann::json out = {
      {"block", choice_.block},
      {"point", vector(point_.position)},
      {"normal", vector(point_.normal)},
      {"latent", map_.latent},
      {"latent_position", vector(inside_.positions()[static_cast<size_t>(map_.latent)])},
      {"most", map_.most},
      {"latents", inside_.positions().size()}};
  if (choice_.head >= 0) out["head"] = choice_.head;
  if (entropy_) out["entropy"] = *entropy_;
  return out;
}

std::string AttentionLook::text() const {
  std::string out = concat("attention of ", choice_.block);
  if (choice_.head >= 0) out += concat(", head ", choice_.head);
  out += concat(" at ", point_.position.x, ",", point_.position.y, ",", point_.position.z,
                ": full color is ", map_.most, " times an even share");
  if (entropy_) out += concat("; entropy of the block over log n: ", *entropy_);
  return out;
}

}  // namespace lte::infer
