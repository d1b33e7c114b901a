#include "lte/scene/pbrt/image.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lte/base/parallel.h"
#include "lte/base/to_number.h"
#include "lte/image/tonemap.h"
#include "lte/scene/pbrt/named_file.h"

namespace lte::scene::pbrt {
namespace {

using Kind = TextureNode::Kind;

constexpr double kCheckTexels = 128;  ///< a side of a square of a baked checkerboard
constexpr double kMaxBaked = 4096;    ///< texels a side of a baked picture

/// Images and checkerboards of an expression.
void collect(const TextureNode& node, std::vector<const TextureNode*>* leaves) {
  if (node.kind == Kind::Image || node.kind == Kind::Checkerboard) leaves->push_back(&node);
  for (const TexturePtr& child : {node.first, node.second, node.amount}) {
    if (child) collect(*child, leaves);
  }
}

/// Maps our uv, whose v points down, into a picture that covers [0, period]² of st.
TextureRef reference(int picture, const Mapping& mapping, Wrap wrap, int period) {
  const auto p = static_cast<float>(period);
  TextureRef out;
  out.texture = picture;
  out.wrap_u = out.wrap_v = wrap;
  out.scale = {mapping.scale.x / p, -mapping.scale.y / p};
  out.offset = {mapping.offset.x / p, 1 - mapping.offset.y / p};
  return out;
}

uint8_t to_byte(float value) {
  return static_cast<uint8_t>(std::lround(255 * std::clamp(value, 0.0f, 1.0f)));
}

/// Linear values as an sRGB texture of [0, 1] and a factor: 1, or the largest value if that is
/// more.
std::shared_ptr<const Texture> quantize(const std::vector<float>& linear, int width, int height,
                                        float* gain) {
  *gain = std::max(1.0f, *std::max_element(linear.begin(), linear.end()));
  std::vector<uint8_t> texels(linear.size());
  for (size_t i = 0; i < linear.size(); ++i)
    texels[i] = to_byte(image::linear_to_srgb(linear[i] / *gain));
  return std::make_shared<const Texture>(width, height, std::move(texels), /*srgb=*/true);
}

double gamma_of(const std::string& encoding, const Location& at) {
  const auto gamma = to_number<double>(std::string_view(encoding).substr(6));  // behind "gamma "
  if (!gamma || !(*gamma > 0 && *gamma < 100))
    fail(at, "encoding ", quote(encoding), ": expected a positive number behind gamma");
  return *gamma;
}

bool is_whole(float value) { return std::abs(value - std::round(value)) < 1e-4f; }

}  // namespace

int ImageTable::plain(const std::string& file, const std::string& encoding, const Location& at) {
  const SceneFilePtr found = files_.find(file, at);
  const auto [place, is_new] =
      plain_.insert({{found->name(), encoding}, static_cast<int>(pictures_.size())});
  if (is_new) {
    Picture picture;
    picture.file = found;
    picture.encoding = encoding;
    picture.at = at;
    pictures_.push_back(std::move(picture));
  }
  return place->second;
}

TextureRef ImageTable::light_image(const std::string& file, const Location& at) {
  return reference(plain(file, "sRGB", at), {}, Wrap::ClampToEdge, 1);
}

TextureRef ImageTable::normal_map(const std::string& file, const Location& at) {
  return reference(plain(file, "linear", at), {}, Wrap::Repeat, 1);
}

Appearance ImageTable::resolve(const TexturePtr& texture) {
  if (texture->kind == Kind::Constant) return {texture->value, {}};
  if (texture->kind == Kind::Image && !texture->invert) {
    const int picture = plain(texture->file, texture->encoding, texture->at);
    return {texture->value, reference(picture, texture->mapping, texture->wrap, 1)};
  }
  const auto found = baked_.find(texture);
  return found != baked_.end() ? found->second : (baked_[texture] = bake(texture));
}

/// Plans a picture of a whole expression. Where all leaves map uv to st alike, it covers one period
/// of st and keeps the mapping; otherwise it covers the unit square of uv, which is exact only
/// where every leaf repeats there a whole number of times.
Appearance ImageTable::bake(const TexturePtr& texture) {
  std::vector<const TextureNode*> leaves;
  collect(*texture, &leaves);
  Picture picture;
  picture.baked = texture;
  picture.at = texture->at;
  bool same = true, clamps = false, repeats = false, whole = true;
  for (const TextureNode* leaf : leaves) {
    const bool check = leaf->kind == Kind::Checkerboard;
    if (!check) picture.leaves[leaf] = plain(leaf->file, leaf->encoding, leaf->at);
    if (check) picture.period = 2;
    same &= leaf->mapping == leaves[0]->mapping;
    (!check && leaf->wrap == Wrap::ClampToEdge ? clamps : repeats) = true;
    const float cells = check ? 2 : 1;
    whole &= is_whole(leaf->mapping.scale.x / cells) && is_whole(leaf->mapping.scale.y / cells);
  }
  picture.in_st = same && !(clamps && repeats);
  if (!picture.in_st) {
    picture.period = 1;
    if (clamps || !whole)
      ignored_->add("texture of textures with different mappings: baked over the unit square of uv",
                    texture->at);
  }
  const int index = static_cast<int>(pictures_.size());
  const TextureRef ref =
      reference(index, picture.in_st ? leaves[0]->mapping : Mapping{},
                picture.in_st && clamps ? Wrap::ClampToEdge : Wrap::Repeat, picture.period);
  pictures_.push_back(std::move(picture));
  return {{1, 1, 1}, ref};
}

/// Holds the sizes in the headers of all files against the limits.
void ImageTable::count_files() const {
  std::vector<DeclaredPicture> declared;
  for (const Picture& picture : pictures_) {
    if (picture.baked != nullptr) continue;
    const image::DeclaredSize size = declared_size(*picture.file, picture.at);
    declared.push_back({concat(picture.at, ": ", picture.file->name()), size.width, size.height});
  }
  files_.budget().add_pictures(declared, kTextureBytes);
}

void ImageTable::count_baked() const {
  std::vector<DeclaredPicture> declared;
  for (const Picture& picture : pictures_) {
    if (picture.baked == nullptr) continue;
    double width = 0, height = 0;
    size_of(picture, &width, &height);
    declared.push_back({concat(picture.at, ": a texture of textures"), static_cast<int64_t>(width),
                        static_cast<int64_t>(height)});
  }
  files_.budget().add_pictures(declared, kTextureBytes);
}

void ImageTable::decode(Picture* picture) const {
  const image::Picture file =
      decode_picture(*picture->file, picture->at, files_.limits().texture_pixels);
  const image::Image& image = file.image;
  const auto pixels = static_cast<size_t>(image.width) * static_cast<size_t>(image.height);
  const auto channels = static_cast<size_t>(image.channels);
  const auto value = [&](size_t pixel, size_t c) {
    return image.pixels[pixel * channels + (channels >= 3 ? c : 0)];
  };
  if (file.coded && !picture->encoding.starts_with("gamma")) {
    std::vector<uint8_t> texels(pixels * 3);
    for (size_t i = 0; i < texels.size(); ++i) texels[i] = to_byte(value(i / 3, i % 3));
    picture->texture = std::make_shared<const Texture>(image.width, image.height, std::move(texels),
                                                       picture->encoding == "sRGB");
    return;
  }
  const double gamma = file.coded ? gamma_of(picture->encoding, picture->at) : 1;
  std::vector<float> rgb(pixels * 3);
  for (size_t i = 0; i < rgb.size(); ++i) {
    const float texel = value(i / 3, i % 3);
    if (!std::isfinite(texel))
      fail(picture->at, picture->file->name(), ": pixel ", i / 3 % static_cast<size_t>(image.width),
           ", ", i / 3 / static_cast<size_t>(image.width), " is not finite");
    rgb[i] = file.coded ? static_cast<float>(std::pow(texel, gamma)) : std::max(0.0f, texel);
  }
  picture->texture = quantize(rgb, image.width, image.height, &picture->gain);
}

Rgb ImageTable::value(const Picture& picture, const TextureNode& node, const Vec2& p) const {
  const auto child = [&](const TexturePtr& of) { return value(picture, *of, p); };
  const Vec2 st = picture.in_st ? p : node.mapping(p);
  switch (node.kind) {
    case Kind::Constant:
      return node.value;
    case Kind::Image: {
      const Picture& leaf = pictures_[static_cast<size_t>(picture.leaves.at(&node))];
      const Rgb color =
          leaf.texture->sample({st.x, 1 - st.y}, node.wrap, node.wrap, 0) * leaf.gain * node.value;
      return node.invert ? max(Rgb{1, 1, 1} - color, {0, 0, 0}) : color;
    }
    case Kind::Scale:
      return child(node.first) * child(node.second);
    case Kind::Mix: {
      const Rgb amount = child(node.amount);
      return child(node.first) * (Rgb{1, 1, 1} - amount) + child(node.second) * amount;
    }
    case Kind::Checkerboard: {
      const float cell = std::floor(st.x) + std::floor(st.y);
      return child(cell - 2 * std::floor(cell / 2) == 0 ? node.first : node.second);
    }
  }
  return {};
}

/// As many texels as the finest image or checkerboard of the expression has over the picture.
void ImageTable::size_of(const Picture& picture, double* width, double* height) const {
  std::vector<const TextureNode*> leaves;
  collect(*picture.baked, &leaves);
  *width = *height = 1;
  for (const TextureNode* leaf : leaves) {
    double w = kCheckTexels, h = kCheckTexels;  // of one unit of st
    if (leaf->kind == Kind::Image) {
      const Texture& texture = *pictures_[static_cast<size_t>(picture.leaves.at(leaf))].texture;
      w = texture.width();
      h = texture.height();
    }
    const bool st = picture.in_st;
    *width = std::max(*width, w * (st ? picture.period : std::abs(leaf->mapping.scale.x)));
    *height = std::max(*height, h * (st ? picture.period : std::abs(leaf->mapping.scale.y)));
  }
  const double most =
      std::min(kMaxBaked, std::sqrt(static_cast<double>(files_.limits().texture_pixels)));
  *width = std::ceil(std::min(*width, most));
  *height = std::ceil(std::min(*height, most));
}

/// Evaluates the expression at the middle of each texel.
void ImageTable::evaluate(Picture* picture) const {
  double columns = 0, rows = 0;
  size_of(*picture, &columns, &rows);
  const int width = std::max(1, static_cast<int>(columns)),
            height = std::max(1, static_cast<int>(rows));
  std::vector<float> linear;
  linear.reserve(static_cast<size_t>(width) * static_cast<size_t>(height) * 3);
  const auto period = static_cast<float>(picture->period);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Vec2 p{period * (static_cast<float>(x) + 0.5f) / static_cast<float>(width),
                   period * (1 - (static_cast<float>(y) + 0.5f) / static_cast<float>(height))};
      const Rgb color = value(*picture, *picture->baked, p);
      for (int c = 0; c < 3; ++c)
        linear.push_back(std::isfinite(color[c]) ? std::max(0.0f, color[c]) : 0);
    }
  }
  picture->texture = quantize(linear, width, height, &picture->gain);
}

std::vector<std::shared_ptr<const Texture>> ImageTable::finish(std::vector<Material>* materials) {
  // Files first, as baked pictures read them.
  for (const bool baked : {false, true}) {
    baked ? count_baked() : count_files();
    parallel_for(static_cast<int64_t>(pictures_.size()), 1, [&](int64_t begin, int64_t end) {
      for (int64_t i = begin; i < end; ++i) {
        Picture& picture = pictures_[static_cast<size_t>(i)];
        if ((picture.baked != nullptr) != baked) continue;
        if (baked) {
          evaluate(&picture);
        } else {
          decode(&picture);
        }
      }
    });
  }
  // Pictures that only baked ones read stay behind.
  std::vector<int> index(pictures_.size(), kNone);
  std::vector<std::shared_ptr<const Texture>> out;
  const auto place = [&](TextureRef* ref, Rgb* factor) {
    if (ref->texture == kNone) return;
    const auto picture = static_cast<size_t>(ref->texture);
    if (index[picture] == kNone) {
      index[picture] = static_cast<int>(out.size());
      out.push_back(pictures_[picture].texture);
    }
    ref->texture = index[picture];
    *factor *= pictures_[picture].gain;
  };
  for (Material& material : *materials) {
    place(&material.base_color_texture, &material.base_color);
    place(&material.emission_texture, &material.emission);
    Rgb unused;  // directions have no factor
    place(&material.normal_texture, &unused);
  }
  return out;
}

}  // namespace lte::scene::pbrt
