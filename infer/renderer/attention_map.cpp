#include "infer/renderer/attention_map.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "infer/picture/projection.h"
#include "lte/base/check.h"
#include "lte/base/srgb.h"
#include "lte/scene/closest_point.h"

namespace lte::infer {
namespace {

using runtime::SceneAttention;

constexpr float kReach = 0.05f;  // of the scene's widest side
const std::string kDecoder = "decoder";

/// Matplotlib's "inferno" by eighths, sRGB: even steps of lightness, and readable in grey.
constexpr std::array<std::array<int, 3>, 9> kHeat = {{{0x00, 0x00, 0x04},
                                                      {0x21, 0x0c, 0x4a},
                                                      {0x56, 0x10, 0x6e},
                                                      {0x89, 0x22, 0x6a},
                                                      {0xbb, 0x37, 0x54},
                                                      {0xe3, 0x59, 0x32},
                                                      {0xf9, 0x8c, 0x0a},
                                                      {0xf9, 0xc9, 0x32},
                                                      {0xfc, 0xff, 0xa4}}};
constexpr Rgb kGrey{0.16f, 0.16f, 0.17f};
constexpr float kFromGrey = 0.1f;  // of the scale, in which grey gives way to heat
constexpr float kLeastShade = 0.35f;

/// Linear light of a value in [0, 1].
Rgb heat(float t) {
  const float at = std::clamp(t, 0.0f, 1.0f) * static_cast<float>(kHeat.size() - 1);
  const auto i = std::min(static_cast<size_t>(at), kHeat.size() - 2);
  const float f = at - static_cast<float>(i);
  Rgb out;
  for (size_t c = 0; c < 3; ++c) {
    const auto low = static_cast<float>(kHeat[i][c]), high = static_cast<float>(kHeat[i + 1][c]);
    out[static_cast<int>(c)] = srgb_to_linear((low + f * (high - low)) / 255);
  }
  return out;
}

void ring(const Projection::Place& place, image::Image* picture) {
  const float radius = std::max(3.5f, static_cast<float>(picture->height) / 50);
  const float line = std::max(1.0f, radius / 4);
  const int reach = static_cast<int>(radius + 2 * line) + 1;
  const auto cx = static_cast<int>(place.x), cy = static_cast<int>(place.y);
  for (int y = std::max(0, cy - reach); y <= std::min(picture->height - 1, cy + reach); ++y) {
    for (int x = std::max(0, cx - reach); x <= std::min(picture->width - 1, cx + reach); ++x) {
      const float off = std::abs(std::hypot(static_cast<float>(x) + 0.5f - place.x,
                                            static_cast<float>(y) + 0.5f - place.y) -
                                 radius);
      if (off < line) picture->set_rgb(x, y, off < line / 2 ? Rgb{1, 1, 1} : Rgb{0, 0, 0});
    }
  }
}

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
    const char* first = choice.block.data() + kDecoder.size() + 1;
    const char* last = choice.block.data() + choice.block.size();
    size_t layer = 0;
    const auto [end, error] = std::from_chars(first, last, layer);
    if (error != std::errc() || end != last || layer >= read.by_layer.size())
      refuse_block(inside, choice.block, read.by_layer.size());
    shares = &read.by_layer[layer];
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

void paint_attention(const SceneAttention& inside, const AttentionMap& map, const Vec3& mark,
                     const scene::Camera& camera, Frame* frame) {
  const int width = frame->depth.width, height = frame->depth.height;
  const Projection projection(camera, width, height);
  std::vector<Vec3> position, normal;
  std::vector<size_t> pixels;
  for (size_t i = 0; i < frame->depth.pixels.size(); ++i) {
    const float depth = frame->depth.pixels[i];
    if (!(depth > 0)) continue;
    const auto x = static_cast<float>(i % static_cast<size_t>(width)) + 0.5f,
               y = static_cast<float>(i / static_cast<size_t>(width)) + 0.5f;
    position.push_back(projection.point(x, y, depth));
    normal.push_back(frame->normal.rgb(i));
    pixels.push_back(i);
  }
  const std::vector<float> values = inside.interpolate(map.values, position, normal);
  frame->attention = image::Image(width, height, 1);
  frame->color = image::Image(width, height, 3);
  for (size_t k = 0; k < pixels.size(); ++k) {
    frame->attention.pixels[pixels[k]] = values[k];
    const float t = map.most > 0 ? std::max(0.0f, values[k] / map.most) : 0;
    const float slant = std::abs(dot(normal[k], normalize(camera.origin - position[k])));
    const float shade = kLeastShade + (1 - kLeastShade) * slant;
    const float mix = std::min(1.0f, t / kFromGrey);
    frame->color.set_rgb(pixels[k], (kGrey * (1 - mix) + heat(t) * mix) * shade);
  }
  if (const auto place = projection.place(mark)) ring(*place, &frame->color);
}

}  // namespace lte::infer
