// The pictures that a PBRT scene's materials need: plain ones, and ones made from expressions that
// one image and one factor cannot say ("baked").
#pragma once

#include <compare>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "lte/scene/pbrt/texture.h"

namespace lte::scene::pbrt {

/// A factor, and perhaps an image, as Material has them.
struct Appearance {
  Rgb factor{1, 1, 1};
  TextureRef texture;  ///< `texture.texture` counts pictures of the table until finish()
};

class ImageTable {
 public:
  ImageTable(const Files& files, IgnoredFeatures* ignored) : files_(files), ignored_(ignored) {}

  Appearance resolve(const TexturePtr& texture);
  /// The picture of an area light, which spans the unit square of uv.
  TextureRef light_image(const std::string& file, const Location& at);

  /// A material's normal map: a picture of linear texels over uv.
  TextureRef normal_map(const std::string& file, const Location& at);

  /// Counts the pictures, then decodes and bakes them in parallel, each once, and turns the
  /// materials' references into indices of the result. A picture with values above 1 is stored
  /// divided by its maximum, which the materials' factors take over.
  std::vector<std::shared_ptr<const Texture>> finish(std::vector<Material>* materials);

 private:
  struct Picture {
    SceneFilePtr file;     ///< of a plain one
    std::string encoding;  ///< of a plain one
    Location at;
    TexturePtr baked;  ///< the expression of the others
    bool in_st = false;
    int period = 1;
    std::map<const TextureNode*, int> leaves;  ///< the plain pictures that a baked one reads

    std::shared_ptr<const Texture> texture;
    float gain = 1;
  };

  int plain(const std::string& file, const std::string& encoding, const Location& at);
  Appearance bake(const TexturePtr& texture);
  void count_files() const;
  void count_baked() const;
  void decode(Picture* picture) const;
  void evaluate(Picture* picture) const;
  Rgb value(const Picture& picture, const TextureNode& node, const Vec2& p) const;
  void size_of(const Picture& picture, double* width, double* height) const;

  const Files& files_;
  IgnoredFeatures* ignored_;
  std::vector<Picture> pictures_;
  std::map<std::pair<std::string, std::string>, int> plain_;
  std::map<TexturePtr, Appearance> baked_;
};

}  // namespace lte::scene::pbrt
