#include "lte/scene/pbrt/texture.h"

#include "lte/scene/pbrt/named_spectra.h"

namespace lte::scene::pbrt {
namespace {

using Kind = TextureNode::Kind;

/// Expressions share their parts, so that a few lines can name 2^64 of them.
constexpr size_t kMaxSize = 1000;

bool is_constant(const TexturePtr& texture) { return texture->kind == Kind::Constant; }

TexturePtr combine(Kind kind, const TexturePtr& first, const TexturePtr& second,
                   const TexturePtr& amount, const Mapping& mapping, const Location& at) {
  auto out = std::make_shared<TextureNode>();
  out->kind = kind;
  out->first = first;
  out->second = second;
  out->amount = amount;
  out->mapping = mapping;
  out->at = at;
  out->size = 1 + first->size + second->size + (amount ? amount->size : 0);
  if (out->size > kMaxSize)
    fail(at, "a texture made of more than ", kMaxSize, " textures of textures");
  return out;
}

}  // namespace

TexturePtr constant_texture(const Rgb& value) {
  auto out = std::make_shared<TextureNode>();
  out->value = value;
  return out;
}

TexturePtr scale_textures(const TexturePtr& first, const TexturePtr& second, const Location& at) {
  if (is_constant(second) && !is_constant(first)) return scale_textures(second, first, at);
  const bool plain = is_constant(second) || (second->kind == Kind::Image && !second->invert);
  if (!is_constant(first) || !plain) return combine(Kind::Scale, first, second, nullptr, {}, at);
  auto out = std::make_shared<TextureNode>(*second);
  out->value = first->value * second->value;
  return out;
}

TexturePtr mix_textures(const TexturePtr& first, const TexturePtr& second, const TexturePtr& amount,
                        const Location& at) {
  if (is_constant(amount)) {
    const Rgb t = amount->value, one{1, 1, 1};
    if (t == Rgb{} || first == second) return first;
    if (t == one) return second;
    if (is_constant(first) && is_constant(second))
      return constant_texture(first->value * (one - t) + second->value * t);
  }
  return combine(Kind::Mix, first, second, amount, {}, at);
}

TextureTable::TextureTable(const World& world, const Files& files, IgnoredFeatures* ignored)
    : files_(files), ignored_(ignored) {
  // In the order of the file: each may name those before it, which excludes cycles.
  for (const TextureDef& def : world.textures) {
    built_[{def.is_float, def.name}] = build(def);
    ignore_unused(def.params, ignored_);
  }
}

TexturePtr TextureTable::of(const Params& params, const std::string& name,
                            const Rgb& fallback) const {
  return parameter(params, name, fallback, false);
}

TexturePtr TextureTable::of_float(const Params& params, const std::string& name,
                                  float fallback) const {
  return parameter(params, name, {fallback, fallback, fallback}, true);
}

TexturePtr TextureTable::find(const std::string& name, bool is_float, const Location& at) const {
  for (const bool kind : {is_float, !is_float}) {
    const auto found = built_.find({kind, name});
    if (found != built_.end()) return found->second;
  }
  fail(at, "no texture ", quote(name), " is defined");
}

TexturePtr TextureTable::parameter(const Params& params, const std::string& name,
                                   const Rgb& fallback, bool is_float) const {
  const Parameter* parameter = params.find(name);
  if (parameter == nullptr) return constant_texture(fallback);
  if (!parameter->is_texture())
    return constant_texture(to_reflectance(*parameter, files_, ignored_));
  if (parameter->strings.size() != 1)
    fail(parameter->at, "parameter ", quote(name), " takes one texture, got ",
         parameter->strings.size());
  return find(parameter->strings[0], is_float, parameter->at);
}

Mapping TextureTable::read_mapping(const Params& params) const {
  const std::string kind = params.text("mapping", "uv");
  if (kind != "uv")
    ignored_->add("mapping " + quote(kind) + " of a texture: uv taken", params.at());
  Mapping out;
  out.scale = {static_cast<float>(params.number("uscale", 1)),
               static_cast<float>(params.number("vscale", 1))};
  out.offset = {static_cast<float>(params.number("udelta", 0)),
                static_cast<float>(params.number("vdelta", 0))};
  return out;
}

TexturePtr TextureTable::build_image(const TextureDef& def) const {
  const Params& params = def.params;
  auto out = std::make_shared<TextureNode>();
  out->kind = Kind::Image;
  out->at = params.at();
  out->file = params.text("filename", "");
  if (out->file.empty()) fail(params.at(), params.what(), " needs \"string filename\"");
  out->encoding = params.text("encoding", "sRGB");
  if (out->encoding != "sRGB" && out->encoding != "linear" && !out->encoding.starts_with("gamma "))
    fail(params.at(), params.what(), ": unknown encoding ", quote(out->encoding),
         ", expected sRGB, linear or gamma followed by a number");
  out->invert = params.boolean("invert", false);
  const auto scale = static_cast<float>(params.number("scale", 1));
  out->value = {scale, scale, scale};
  if (scale < 0) fail(params.at(), params.what(), ": \"scale\" is negative");
  const std::string wrap = params.text("wrap", "repeat");
  if (wrap != "repeat") out->wrap = Wrap::ClampToEdge;
  if (wrap != "repeat" && wrap != "clamp")
    ignored_->add("wrap " + quote(wrap) + " of a texture: clamped instead", params.at());
  out->mapping = read_mapping(params);
  params.has("filter"), params.has("maxanisotropy");  // how it is sampled, not what it is
  return out;
}

TexturePtr TextureTable::build_checkerboard(const TextureDef& def) const {
  const Params& params = def.params;
  const TexturePtr even = parameter(params, "tex1", {1, 1, 1}, def.is_float);
  const TexturePtr odd = parameter(params, "tex2", {0, 0, 0}, def.is_float);
  if (params.integer("dimension", 2) != 2) {
    ignored_->add("checkerboard in three dimensions: its mean taken", params.at());
    return mix_textures(even, odd, constant_texture({0.5f, 0.5f, 0.5f}), params.at());
  }
  const Mapping mapping = read_mapping(params);
  if (is_constant(even) && is_constant(odd) && even->value == odd->value) return even;
  return combine(Kind::Checkerboard, even, odd, nullptr, mapping, params.at());
}

TexturePtr TextureTable::build(const TextureDef& def) const {
  const Params& params = def.params;
  const auto part = [&](const char* name, const Rgb& fallback) {
    return parameter(params, name, fallback, def.is_float);
  };
  if (def.type == "constant") return part("value", {1, 1, 1});
  if (def.type == "imagemap") return build_image(def);
  if (def.type == "checkerboard") return build_checkerboard(def);
  if (def.type == "scale") {
    const bool v3 = params.has("tex1") || params.has("tex2");
    const TexturePtr first = part(v3 ? "tex1" : "tex", {1, 1, 1});
    return scale_textures(
        first, v3 ? part("tex2", {1, 1, 1}) : parameter(params, "scale", {1, 1, 1}, true),
        params.at());
  }
  if (def.type == "mix" || def.type == "directionmix") {
    if (def.type == "directionmix")
      ignored_->add("Texture \"directionmix\": the mean of its two taken", params.at());
    return mix_textures(part("tex1", def.type == "mix" ? Rgb{} : Rgb{1, 1, 1}),
                        part("tex2", def.type == "mix" ? Rgb{1, 1, 1} : Rgb{}),
                        parameter(params, "amount", {0.5f, 0.5f, 0.5f}, true), params.at());
  }
  ignored_->add("Texture " + quote(def.type) + ": 0.5 taken", params.at());
  for (const Parameter* parameter : params.unused()) params.has(parameter->name);
  return constant_texture({0.5f, 0.5f, 0.5f});
}

}  // namespace lte::scene::pbrt
