// PBRT's textures as expressions over pictures.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "lte/scene/pbrt/world.h"

namespace lte::scene::pbrt {

/// Maps uv to the st of a texture; v and t point upwards.
struct Mapping {
  Vec2 scale{1, 1}, offset{0, 0};

  Vec2 operator()(const Vec2& uv) const {
    return {uv.x * scale.x + offset.x, uv.y * scale.y + offset.y};
  }
  friend bool operator==(const Mapping& a, const Mapping& b) {
    return a.scale.x == b.scale.x && a.scale.y == b.scale.y && a.offset.x == b.offset.x &&
           a.offset.y == b.offset.y;
  }
};

struct TextureNode;
using TexturePtr = std::shared_ptr<const TextureNode>;

struct TextureNode {
  enum class Kind { Constant, Image, Scale, Mix, Checkerboard };
  Kind kind = Kind::Constant;
  Rgb value{1, 1, 1};    ///< of a constant; an image's factor
  std::string file;      ///< of an image, as the scene names it
  std::string encoding;  ///< of an image: "sRGB", "linear" or "gamma 2.2"
  bool invert = false;   ///< of an image: 1 - value * texel
  Wrap wrap = Wrap::Repeat;
  Mapping mapping;  ///< of images and checkerboards
  TexturePtr first, second, amount;
  size_t size = 1;  ///< nodes in the whole expression
  Location at;
};

TexturePtr constant_texture(const Rgb& value);

/// The expression (1 - amount) * first + amount * second.
TexturePtr mix_textures(const TexturePtr& first, const TexturePtr& second, const TexturePtr& amount,
                        const Location& at);

/// The expression first * second.
TexturePtr scale_textures(const TexturePtr& first, const TexturePtr& second, const Location& at);

/// The textures of a scene.
class TextureTable {
 public:
  /// @throws lte::Error with file and line: unknown names, expressions of absurd size.
  TextureTable(const World& world, const Files& files, IgnoredFeatures* ignored);

  /// A material's parameter: a value, or a texture by name; `fallback` where it is missing.
  TexturePtr of(const Params& params, const std::string& name, const Rgb& fallback) const;
  /// The same for a parameter that is a number, as the amount of a mixture.
  TexturePtr of_float(const Params& params, const std::string& name, float fallback) const;

 private:
  TexturePtr build(const TextureDef& def) const;
  TexturePtr build_image(const TextureDef& def) const;
  TexturePtr build_checkerboard(const TextureDef& def) const;
  TexturePtr find(const std::string& name, bool is_float, const Location& at) const;
  TexturePtr parameter(const Params& params, const std::string& name, const Rgb& fallback,
                       bool is_float) const;
  Mapping read_mapping(const Params& params) const;

  const Files& files_;
  IgnoredFeatures* ignored_;
  std::map<std::pair<bool, std::string>, TexturePtr> built_;  ///< by is_float and name
};

}  // namespace lte::scene::pbrt
