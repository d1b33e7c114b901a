#include "infer/view/attention_view.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "infer/renderer/attention_map.h"
#include "lte/base/check.h"
#include "lte/pathtrace/ray_offset.h"

namespace lte::infer::view {
namespace {

using nlohmann::json;

/// A number in few digits: a reply has thousands.
double rounded(float value, double digits) { return std::round(double{value} * digits) / digits; }
constexpr double kPlace = 1e3, kValue = 1e3;

json place_json(const Vec3& v) {
  return {rounded(v.x, kPlace), rounded(v.y, kPlace), rounded(v.z, kPlace)};
}

/// Whether nothing stands between a camera and a point of a surface that faces it.
bool sees(const pathtrace::Bvh& bvh, const scene::Camera& camera, const Vec3& position,
          const Vec3& normal) {
  const Vec3 way = camera.origin - position;
  if (dot(way, normal) <= 0) return false;
  return !bvh.occluded({pathtrace::offset_origin(position, normal), way, 0, 1});
}

}  // namespace

void AttentionView::record(const SessionState& state) {
  if (inside_ && version_ == state.version()) return;
  inside_.reset();  // two at a time would need twice the memory
  inside_.emplace(state.record_attention());
  version_ = state.version();
  entropies_.clear();
  for (size_t block = 0; block < inside_->blocks().size(); ++block)
    entropies_.push_back(inside_->entropy(block));
}

std::string AttentionView::answer(const SessionState& state, const scene::Camera& camera,
                                  const LookInside& question) {
  const auto found =
      surface_near(state.bvh().scene(), question.position, pointing_reach(state.bvh().bounds()));
  LTE_CHECK(found.has_value(), "there is no surface near the point that was clicked");
  record(state);
  const SurfacePoint point = found->facing(question.position + question.normal);
  AttentionChoice choice;
  choice.block = question.block;
  choice.head = question.head;
  const AttentionMap map = attention_map(*inside_, point, choice);
  const bool few = reads_decoder(choice);  // the others have no weight, as nobody reads them
  json dots = json::array();
  for (size_t i = 0; i < map.values.size(); ++i) {
    const Vec3 &position = inside_->positions()[i], &normal = inside_->normals()[i];
    if (few && map.values[i] == 0) continue;
    if (!sees(state.bvh(), camera, position, normal) &&
        !sees(state.bvh(), camera, position, -normal))
      continue;
    json entry = place_json(position);
    entry.push_back(rounded(map.values[i], kValue));
    dots.push_back(std::move(entry));
  }
  json blocks = json::array();
  for (size_t i = 0; i < inside_->blocks().size(); ++i) {
    const runtime::AttentionBlock& block = inside_->blocks()[i];
    json entry = {{"name", block.name}, {"heads", block.heads}, {"points", block.points}};
    if (std::isfinite(entropies_[i]))
      entry["entropy"] = rounded(static_cast<float>(entropies_[i]), 1e4);
    blocks.push_back(std::move(entry));
  }
  const json out = {{"type", "attention"},
                    {"block", choice.block},
                    {"head", choice.head},
                    {"position", place_json(point.position)},
                    {"normal", place_json(point.normal)},
                    {"latent", place_json(inside_->positions()[static_cast<size_t>(map.latent)])},
                    {"latents", map.values.size()},
                    {"layers", inside_->decoder_layers()},
                    {"most", rounded(map.most, kValue)},
                    {"blocks", std::move(blocks)},
                    {"dots", std::move(dots)}};
  return out.dump();
}

}  // namespace lte::infer::view
