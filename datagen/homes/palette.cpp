#include "datagen/homes/palette.h"

#include "datagen/common/textures.h"

namespace lte::datagen::homes {

Palette::Palette(scene::Scene* scene, std::vector<int64_t> texture_sizes, uint64_t seed)
    : scene_(scene), sizes_(std::move(texture_sizes)), rng_(seed, 0x70616cULL) {
  hue_ = draw(0, 1);
  wood_hue_ = draw(0.06f, 0.1f);
  wood_tone_ = chance(0.35f) ? draw(0.08f, 0.16f) : draw(0.2f, 0.42f);
  wood_saturation_ = draw(0.45f, 0.75f);
}

int Palette::add(const std::string& name, const Rgb& color) {
  scene::Material material;
  material.name = name;
  material.base_color = clamp_albedo(color, kAlbedo);
  scene_->materials.push_back(material);
  return static_cast<int>(scene_->materials.size()) - 1;
}

int Palette::add(const std::string& name, const TexturePtr& texture, Vec2 tile_m) {
  const int material = add(name, {});
  scene_->materials.back().base_color = {1, 1, 1};
  scene::TextureRef& ref = scene_->materials.back().base_color_texture;
  ref.texture = static_cast<int>(scene_->textures.size());
  ref.scale = {1 / tile_m.x, 1 / tile_m.y};
  scene_->textures.push_back(texture);
  return material;
}

template <typename Make>
int Palette::shared(const std::string& role, size_t limit, const Make& make) {
  std::vector<int>& made = roles_[role];
  if (made.empty() || (made.size() < limit && chance(0.4f))) {
    made.push_back(make());
    return made.back();
  }
  return made[rng_.below(made.size())];
}

/// Draws a color of the home's hue, of a neighbouring one, or of the complement.
Rgb Palette::scheme_color(float saturation, float low, float high) {
  const float turn = chance(0.25f) ? 0.5f : draw(-0.06f, 0.06f);
  const float s = draw(0.5f * saturation, saturation);
  return make_color(hue_ + turn + 1, s, draw(low, high));
}

int Palette::cloth(const std::string& name, const Rgb& first, const Rgb& second, bool printed) {
  if (!printed) return add(name, weave(size(), first, second, 64, &rng_), {0.25f, 0.25f});
  const auto kind = static_cast<Cloth>(rng_.below(kCloths));
  const int repeats = count(2, 6);
  return add(name, printed_cloth(size(), kind, first, second, repeats, &rng_), {0.5f, 0.5f});
}

int Palette::wood() {
  return shared("wood", 2, [this] {
    const bool main = roles_["wood"].empty();
    const float tone = main ? wood_tone_ : draw(0.08f, 0.4f);
    const Rgb base = make_color(wood_hue_, wood_saturation_, tone);
    return add("wood", wood_grain(size(), base, &rng_), {1.2f, 0.5f});
  });
}

int Palette::front() {
  return shared("front", 2, [this] { return chance(0.5f) ? wood() : lacquer(); });
}

int Palette::lacquer() {
  return shared("lacquer", 2, [this] {
    if (chance(0.6f)) return add("lacquer", make_color(0.1f, draw(0, 0.08f), draw(0.6f, 0.8f)));
    return add("lacquer", scheme_color(0.45f, 0.1f, 0.5f));
  });
}

int Palette::upholstery() {
  return shared("upholstery", 2, [this] {
    const Rgb base = chance(0.5f)
                         ? make_color(draw(0.06f, 0.12f), draw(0.05f, 0.35f), draw(0.15f, 0.55f))
                         : scheme_color(0.55f, 0.08f, 0.4f);
    return cloth("upholstery", base, base * draw(0.75f, 0.95f), false);
  });
}

int Palette::accent() {
  return shared("accent", 4, [this] {
    return cloth("accent", scheme_color(0.85f, 0.12f, 0.45f), scheme_color(0.4f, 0.4f, 0.7f),
                 chance(0.5f));
  });
}

int Palette::bedding() {
  return shared("bedding", 2, [this] {
    const Rgb base = make_color(draw(0.05f, 0.14f), draw(0, 0.12f), draw(0.6f, 0.78f));
    return cloth("bedding", base, base * 0.95f, false);
  });
}

int Palette::blanket() {
  return shared("blanket", 2, [this] {
    const Rgb ground = scheme_color(0.5f, 0.15f, 0.6f);
    return cloth("blanket", ground, scheme_color(0.4f, 0.3f, 0.7f), chance(0.5f));
  });
}

int Palette::curtain() {
  return shared("curtain", 1, [this] {
    const Rgb base = chance(0.5f) ? make_color(0.1f, draw(0, 0.2f), draw(0.4f, 0.7f))
                                  : scheme_color(0.5f, 0.15f, 0.5f);
    return cloth("curtain", base, base * 0.9f, chance(0.3f));
  });
}

int Palette::metal() {
  return shared("metal", 1, [this] {
    const Rgb kinds[] = {{0.45f, 0.45f, 0.44f}, {0.5f, 0.36f, 0.15f}, {0.05f, 0.05f, 0.05f}};
    return add("metal", kinds[rng_.below(3)]);
  });
}

int Palette::chrome() {
  return shared("chrome", 1, [this] { return add("chrome", {0.6f, 0.6f, 0.61f}); });
}
int Palette::ceramic() {
  return shared("ceramic", 1, [this] {
    return add("ceramic", Rgb{1, 0.995f, 0.98f} * draw(0.74f, 0.82f));
  });
}

int Palette::worktop() {
  return shared("worktop", 1, [this] {
    if (chance(0.3f)) return wood();
    const bool dark = chance(0.4f);
    const Rgb base =
        make_color(draw(0, 1), draw(0, 0.15f), dark ? draw(0.06f, 0.15f) : draw(0.5f, 0.7f));
    return add("worktop", marble(size(), base, base * (dark ? 2.5f : 0.55f), &rng_), {1, 1});
  });
}

int Palette::crockery() {
  return shared("crockery", 4, [this] {
    return chance(0.5f) ? add("crockery", make_color(0.1f, draw(0, 0.1f), draw(0.6f, 0.78f)))
                        : add("crockery", scheme_color(0.7f, 0.1f, 0.5f));
  });
}

int Palette::glass_like() {
  return shared("bottle", 3, [this] {
    return add("bottle", make_color(draw(0.08f, 0.6f), 0.7f, draw(0.06f, 0.15f)));
  });
}

int Palette::leaf() {
  return shared("leaf", 2, [this] {
    return add("leaf", make_color(draw(0.22f, 0.36f), draw(0.6f, 0.8f), draw(0.1f, 0.22f)));
  });
}
int Palette::pot() {
  return shared("pot", 3, [this] {
    return chance(0.5f) ? add("pot", make_color(0.04f, 0.7f, draw(0.2f, 0.3f))) : crockery();
  });
}
int Palette::soil() {
  return shared("soil", 1, [this] { return add("soil", {0.06f, 0.045f, 0.035f}); });
}
int Palette::bark() {
  return shared("bark", 1, [this] { return add("bark", {0.14f, 0.1f, 0.06f}); });
}
int Palette::paper() {
  return shared("paper", 1, [this] { return add("paper", {0.74f, 0.72f, 0.66f}); });
}
int Palette::books() {
  return shared("books", 1, [this] {
    return add("books", book_spines(size(), kBookSpines, &rng_), {1, 1});
  });
}
int Palette::screen() {
  return shared("screen", 1, [this] { return add("screen", {0.032f, 0.033f, 0.036f}); });
}
int Palette::black() {
  return shared("black", 1, [this] { return add("black", Rgb{1, 1, 1} * draw(0.035f, 0.07f)); });
}
int Palette::mirror() {
  return shared("mirror", 1, [this] { return add("mirror", {0.72f, 0.75f, 0.76f}); });
}
int Palette::trim() {
  return shared("trim", 1, [this] {
    return add("trim", Rgb{1, 0.99f, 0.97f} * draw(0.68f, 0.8f));
  });
}
int Palette::ceiling() {
  return shared("ceiling", 1, [this] {
    return add("ceiling", Rgb{1, 0.995f, 0.98f} * draw(0.74f, 0.82f));
  });
}

int Palette::wall_paint() {
  const float kind = draw(0, 1);
  if (kind < 0.2f) {
    const Rgb ground = scheme_color(0.25f, 0.45f, 0.7f);
    const Rgb figure = chance(0.5f) ? ground * draw(0.7f, 0.85f) : scheme_color(0.4f, 0.3f, 0.6f);
    const int repeats = count(3, 6);
    return add("wallpaper", wallpaper(size(), ground, figure, repeats, &rng_), {1, 1});
  }
  const Rgb base = kind < 0.35f ? scheme_color(0.42f, 0.25f, 0.55f)
                   : kind < 0.6f
                       ? scheme_color(0.16f, 0.5f, 0.75f)
                       : make_color(draw(0.07f, 0.14f), draw(0, 0.15f), draw(0.6f, 0.78f));
  return add("wall", plaster(size(), base, &rng_), {2, 2});
}

int Palette::wall_tiles() {
  return shared("wall tiles", 2, [this] {
    const Rgb tile = chance(0.6f) ? make_color(0.5f, draw(0, 0.06f), draw(0.6f, 0.78f))
                                  : scheme_color(0.5f, 0.2f, 0.6f);
    const Rgb grout = Rgb{1, 1, 1} * draw(0.25f, 0.6f);
    const bool subway = chance(0.5f);
    const int rows = subway ? 8 : count(3, 8);
    return add(
        "wall tiles",
        tiles(size(), tile, grout, subway ? rows / 2 : rows, rows, subway, chance(0.2f), &rng_),
        {0.8f, 0.8f});
  });
}

int Palette::floor_wood() {
  return shared("floor wood", 1, [this] {
    const Rgb base = make_color(wood_hue_, wood_saturation_ * 0.9f,
                                chance(0.3f) ? draw(0.1f, 0.2f) : draw(0.25f, 0.45f));
    return add("floor boards", wood_planks(size(), base, count(9, 14), &rng_), {2.4f, 1.6f});
  });
}

int Palette::floor_tiles() {
  return shared("floor tiles", 2, [this] {
    const Rgb tile = make_color(draw(0.02f, 0.12f), draw(0, 0.3f), draw(0.15f, 0.6f));
    const int n = count(2, 4);
    return add(
        "floor tiles",
        tiles(size(), tile, Rgb{1, 1, 1} * draw(0.15f, 0.5f), n, n, false, chance(0.35f), &rng_),
        {1.2f, 1.2f});
  });
}

int Palette::rug() {
  const Rgb field = scheme_color(0.6f, 0.1f, 0.5f), border = scheme_color(0.6f, 0.06f, 0.3f);
  return add("rug",
             homes::rug(size(), field, border, make_color(0.1f, 0.3f, draw(0.4f, 0.65f)), &rng_),
             {1, 1});
}

int Palette::picture() { return add("picture", painting(size(), &rng_), {1, 1}); }

int Palette::emitter(const std::string& name, const Rgb& radiance, float albedo) {
  const int material = add(name, {});
  scene_->materials.back().base_color = {albedo, albedo,
                                         albedo};  // a pane's is 0, below what paints have
  scene_->materials.back().emission = radiance;
  return material;
}

}  // namespace lte::datagen::homes
