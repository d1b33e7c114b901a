#include "datagen/boxes/materials.h"

namespace lte::datagen::boxes {

MaterialFactory::MaterialFactory(scene::Scene* scene, std::vector<int64_t> texture_sizes,
                                 uint64_t seed)
    : scene_(scene), texture_sizes_(std::move(texture_sizes)), rng_(seed, 0x6d6174ULL) {}

int MaterialFactory::add(const std::string& name, const Rgb& color) {
  scene::Material material;
  material.name = name;
  material.base_color = color;
  scene_->materials.push_back(material);
  return static_cast<int>(scene_->materials.size()) - 1;
}

int MaterialFactory::add(const std::string& name, const TexturePtr& texture, Vec2 tile_m) {
  const int material = add(name, {1, 1, 1});
  scene::TextureRef& ref = scene_->materials.back().base_color_texture;
  ref.texture = static_cast<int>(scene_->textures.size());
  ref.scale = {1 / tile_m.x, 1 / tile_m.y};
  scene_->textures.push_back(texture);
  return material;
}

int MaterialFactory::texture_size() {
  return static_cast<int>(texture_sizes_[rng_.below(texture_sizes_.size())]);
}

Rgb MaterialFactory::color(float saturation_high, float low, float high) {
  const float hue = rng_.uniform();
  const float saturation = rng_.uniform(0, saturation_high);
  return make_color(hue, saturation, rng_.uniform(low, high));
}

template <typename Make>
int MaterialFactory::from_palette(std::vector<int>* palette, size_t limit, const Make& make) {
  if (palette->empty() || (palette->size() < limit && rng_.below(2) == 0)) {
    palette->push_back(make());
    return palette->back();
  }
  return (*palette)[rng_.below(palette->size())];
}

int MaterialFactory::floor() {
  const int size = texture_size();
  const float tile_m = rng_.uniform(0.8f, 2.0f);
  switch (rng_.below(6)) {
    case 0:
    case 1: {
      const float hue = rng_.uniform(0.06f, 0.11f), saturation = rng_.uniform(0.3f, 0.75f);
      const Rgb wood = make_color(hue, saturation, rng_.uniform(0.1f, 0.45f));
      const int planks = 4 + static_cast<int>(rng_.below(8));
      return add("floor planks", make_planks(size, wood, planks, &rng_), {tile_m, tile_m});
    }
    case 2: {
      const Rgb tile = color(0.25f, 0.2f, 0.6f), grout = color(0.1f, 0.1f, 0.4f);
      const int tiles = 2 + static_cast<int>(rng_.below(4));
      return add("floor tiles", make_tiles(size, tile, grout, tiles, &rng_), {tile_m, tile_m});
    }
    case 3: {
      const Rgb first = color(0.5f, 0.05f, 0.25f), second = color(0.3f, 0.35f, 0.7f);
      return add("floor checker", make_checker(size, first, second, 4), {tile_m, tile_m});
    }
    case 4: {
      const Rgb base = color(0.7f, 0.1f, 0.5f);
      return add("carpet", make_noise(size, base, 0.4f, 16, &rng_), {tile_m, tile_m});
    }
    default:
      return add("floor", color(0.3f, 0.1f, 0.6f));
  }
}

int MaterialFactory::wall() {
  const int size = texture_size();
  switch (rng_.below(8)) {
    case 0: {  // strongly colored: color bleeding is what indirect light shows first
      const float hue = rng_.uniform(), saturation = rng_.uniform(0.6f, 0.95f);
      return add("wall colored", make_color(hue, saturation, rng_.uniform(0.15f, 0.45f)));
    }
    case 1: {
      const Rgb first = color(0.3f, 0.4f, 0.75f), second = color(0.5f, 0.3f, 0.7f);
      const int stripes = 2 + static_cast<int>(rng_.below(5));
      return add("wallpaper", make_stripes(size, first, second, stripes), {1, 1});
    }
    case 2: {
      const Rgb base = color(0.25f, 0.4f, 0.7f);
      return add("plaster", make_noise(size, base, 0.25f, 8, &rng_), {2, 2});
    }
    default:
      return add("wall", color(0.25f, 0.4f, 0.85f));
  }
}

int MaterialFactory::ceiling() { return add("ceiling", color(0.06f, 0.6f, 0.85f)); }

int MaterialFactory::wood() {
  return from_palette(&woods_, 2, [this] {
    const float hue = rng_.uniform(0.05f, 0.11f), saturation = rng_.uniform(0.3f, 0.8f);
    const Rgb base = make_color(hue, saturation, rng_.uniform(0.06f, 0.5f));
    return add("wood", make_planks(texture_size(), base, 3, &rng_), {0.9f, 0.9f});
  });
}

int MaterialFactory::paint() {
  return from_palette(&paints_, 4, [this] { return add("paint", color(0.85f, 0.08f, 0.75f)); });
}

int MaterialFactory::fabric() {
  return from_palette(&fabrics_, 3, [this] {
    const Rgb base = color(0.8f, 0.08f, 0.6f);
    return add("fabric", make_noise(texture_size(), base, 0.35f, 12, &rng_), {0.5f, 0.5f});
  });
}

int MaterialFactory::trim() {
  if (trim_ == scene::kNone) trim_ = add("trim", color(0.05f, 0.65f, 0.85f));
  return trim_;
}

int MaterialFactory::dark() {
  if (dark_ == scene::kNone) dark_ = add("dark", color(0.1f, 0.02f, 0.08f));
  return dark_;
}

int MaterialFactory::picture(float width_m, float height_m) {
  return add("picture", make_picture(texture_size(), &rng_), {width_m, height_m});
}

int MaterialFactory::light(const Rgb& radiance) {
  const int material = add("light", color(0.02f, 0.5f, 0.8f));
  scene_->materials.back().emission = radiance;
  return material;
}

}  // namespace lte::datagen::boxes
