#include "infer/renderer/attention_map.h"

#include <algorithm>
#include <cmath>

#include "lte/base/check.h"
#include "lte/base/to_number.h"
#include "lte/scene/closest_point.h"

namespace lte::infer {
namespace {

using runtime::SceneAttention;

constexpr float kReach = 0.05f;  // of the scene's widest side
const std::string kDecoder = "decoder";

std::string names_of(const SceneAttention& inside, size_t layers) {
  std::string out = concat(kDecoder, ", ", kDecoder, ".0 to ", kDecoder, '.', layers - 1);
  for (const runtime::AttentionBlock& block : inside.blocks()) out += ", " + block.name;
  return out;
}

[[noreturn]] void refuse_block(const SceneAttention& inside, const std::string& name,
                               size_t layers) {
  throw Error(concat("there is no block \"", name, "\"; the model has ", names_of(inside, layers)));
}

std::vector<float> decoder_values(const SceneAttention& inside, const SurfacePoint& point,
                                  const AttentionChoice& choice) {
  const runtime::LatentsRead read = inside.read(point.position, point.normal, point.albedo);
  const std::vector<float>* shares = &read.share;
  if (choice.block != kDecoder) {
    const auto layer =
        to_number<size_t>(std::string_view(choice.block).substr(kDecoder.size() + 1));
    if (!layer || *layer >= read.by_layer.size())
      refuse_block(inside, choice.block, read.by_layer.size());
    shares = &read.by_layer[*layer];
  }
  LTE_CHECK(choice.head == SceneAttention::kAllHeads, "head ", choice.head,
            ": the decoder has none, but a weight a channel, of which the mean is shown");
  std::vector<float> out(inside.positions().size(), 0);
  for (size_t k = 0; k < read.latent.size(); ++k) {
    out[static_cast<size_t>(read.latent[k])] =
        (*shares)[k] * static_cast<float>(read.latent.size());
  }
  return out;
}

}  // namespace

SurfacePoint SurfacePoint::facing(const Vec3& viewer) const {
  SurfacePoint out = *this;
  if (dot(normal, viewer - position) < 0) out.normal = -normal;
  return out;
}

float pointing_reach(const Bounds& bounds) { return kReach * max_component(bounds.extent()); }

std::optional<SurfacePoint> surface_near(const scene::Scene& scene, const Vec3& point,
                                         float reach) {
  const scene::ClosestPoint found = scene::closest_point(scene, point);
  if (found.distance > reach) return std::nullopt;
  return SurfacePoint{found.surface.position, found.surface.normal, found.surface.albedo};
}

bool reads_decoder(const AttentionChoice& choice) {
  return choice.block == kDecoder || choice.block.starts_with(kDecoder + '.');
}

size_t find_block(const SceneAttention& inside, const std::string& name) {
  const std::vector<runtime::AttentionBlock>& blocks = inside.blocks();
  const auto found = std::find_if(blocks.begin(), blocks.end(),
                                  [&](const auto& block) { return block.name == name; });
  if (found == blocks.end()) refuse_block(inside, name, inside.decoder_layers());
  return static_cast<size_t>(found - blocks.begin());
}

AttentionMap attention_map(const SceneAttention& inside, const SurfacePoint& point,
                           const AttentionChoice& choice) {
  AttentionMap map;
  map.latent = inside.latent_at(point.position, point.normal);
  map.values = reads_decoder(choice)
                   ? decoder_values(inside, point, choice)
                   : inside.attention(find_block(inside, choice.block), choice.head, map.latent);
  map.most = *std::max_element(map.values.begin(), map.values.end());
  return map;
}

}  // namespace lte::infer
