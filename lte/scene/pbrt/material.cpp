#include "lte/scene/pbrt/material.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "lte/scene/pbrt/named_spectra.h"
#include "lte/scene/surface.h"

namespace lte::scene::pbrt {
namespace {

constexpr int kMaxDepth = 16;           ///< mixtures of mixtures
constexpr float kTexturedAlpha = 0.3f;  ///< where a texture says how rough a conductor is

/// A material whose albedo is one parameter.
struct Simple {
  std::string_view type, parameter;
  float fallback;       ///< pbrt's default
  const char* dropped;  ///< what is left out, for the ignored; nullptr for nothing
};

constexpr std::array<Simple, 13> kSimple = {{
    {"diffuse", "reflectance", 0.5f, nullptr},
    {"coateddiffuse", "reflectance", 0.5f, "its coating is left out"},
    {"diffusetransmission", "reflectance", 0.25f, "its transmission is left out"},
    {"subsurface", "reflectance", 0.5f, "opaque, with its reflectance or 0.5"},
    {"hair", "color", 0.3f, "opaque, with its color or 0.3"},
    {"matte", "Kd", 0.5f, "a pbrt-v3 material, Kd taken"},
    {"plastic", "Kd", 0.25f, "a pbrt-v3 material, Kd taken"},
    {"uber", "Kd", 0.25f, "a pbrt-v3 material, Kd taken"},
    {"substrate", "Kd", 0.5f, "a pbrt-v3 material, Kd taken"},
    {"translucent", "Kd", 0.25f, "a pbrt-v3 material, Kd taken"},
    {"kdsubsurface", "Kd", 0.5f, "a pbrt-v3 material, Kd taken"},
    {"disney", "color", 0.5f, "a pbrt-v3 material, its color taken"},
    {"measured", "reflectance", 0.5f, "diffuse with 0.5"},
}};

/// pbrt-v3's α of a roughness (TrowbridgeReitzDistribution::RoughnessToAlpha).
double remap_v3(double roughness) {
  const double x = std::log(std::max(roughness, 1e-3));
  return 1.62142 + x * (0.819955 + x * (0.1734 + x * (0.0171201 + x * 0.000640711)));
}

bool is_metal(const std::string& type) {
  return type == "conductor" || type == "coatedconductor" || type == "metal" || type == "mirror";
}

bool is_interface(const std::string& type) {
  return type.empty() || type == "interface" || type == "none";
}

TexturePtr gray(float value) { return constant_texture({value, value, value}); }

}  // namespace

MaterialTable::Built MaterialTable::follow(int index, int depth) {
  const MaterialDef& def = world_.materials[static_cast<size_t>(index)];
  if (!def.params) fail(def.at, "no material ", quote(def.name), " is made");
  const auto found = built_.find(index);
  if (found != built_.end()) return found->second;
  if (depth > kMaxDepth) fail(def.at, "mixtures of materials nested deeper than ", kMaxDepth);
  const Built out = build(def, depth);
  if (def.params->has("normalmap") && depth > 0)  // the importer reads that of whole materials
    ignored_->add("normal map of a part of a mix", def.at);
  ignore_unused(*def.params, ignored_);
  built_[index] = out;
  return out;
}

TexturePtr MaterialTable::conductor(const Params& params, const std::string& prefix) {
  if (params.has("reflectance")) return textures_.of(params, "reflectance", {1, 1, 1});
  const Parameter *eta = params.find(prefix + "eta"), *k = params.find(prefix + "k");
  for (const Parameter* parameter : {eta, k}) {
    if (parameter == nullptr || !parameter->is_texture()) continue;
    ignored_->add("texture of a conductor's eta or k, 0.5 taken", parameter->at);
    return gray(0.5f);
  }
  if (eta == nullptr && k == nullptr) return constant_texture(*named_conductor("Cu"));
  return constant_texture(to_conductor(eta, k, files_, ignored_));
}

/// α as pbrt has it, then the roughness whose square it is.
float MaterialTable::roughness(const MaterialDef& def, const std::string& prefix) {
  const Params& params = *def.params;
  const bool v3 = def.type == "metal";
  const TexturePtr both = textures_.of_float(params, prefix + "roughness", v3 ? 0.01f : 0.0f);
  const bool remap = params.boolean("remaproughness", true);
  double product = 1;
  std::array<TexturePtr, 2> axes{both, both};
  for (size_t axis = 0; axis < 2; ++axis) {
    const std::string name = prefix + (axis == 0 ? "uroughness" : "vroughness");
    if (params.has(name)) axes[axis] = textures_.of_float(params, name, 0);
    if (axes[axis]->kind != TextureNode::Kind::Constant) {
      ignored_->add(concat("texture of a conductor's roughness: ", kTexturedAlpha, " taken"),
                    def.at);
      return std::sqrt(kTexturedAlpha);
    }
    const double value = std::clamp(axes[axis]->value.x, 0.0f, 1.0f);
    product *= !remap ? value : v3 ? remap_v3(value) : std::sqrt(value);
  }
  if (!(axes[0]->value == axes[1]->value))
    ignored_->add("anisotropic roughness of a conductor: the geometric mean taken", def.at);
  return static_cast<float>(std::pow(std::clamp(product, 0.0, 1.0), 0.25));
}

MaterialTable::Built MaterialTable::metal(const MaterialDef& def) {
  const Params& params = *def.params;
  if (def.type == "mirror") {
    ignored_->add("Material \"mirror\": a pbrt-v3 material, a conductor with Kr", def.at);
    return {textures_.of(params, "Kr", {0.9f, 0.9f, 0.9f}), {1, 0}};
  }
  const bool coated = def.type == "coatedconductor";
  if (coated) ignored_->add("Material \"coatedconductor\": its coating is left out", def.at);
  const std::string prefix = coated ? "conductor." : "";
  return {conductor(params, prefix), {1, roughness(def, prefix)}};
}

MaterialTable::Built MaterialTable::mixture(const MaterialDef& def, int depth) {
  const Params& params = *def.params;
  const Parameter* names = params.find("materials");
  std::vector<std::string> parts;
  if (names != nullptr) {
    parts = names->strings;
  } else {  // pbrt-v3
    parts = {params.text("namedmaterial1", ""), params.text("namedmaterial2", "")};
  }
  if (parts.size() != 2) fail(def.at, "a mix takes two materials, got ", parts.size());
  std::array<TexturePtr, 2> albedos;
  std::array<Gloss, 2> glosses;
  for (size_t i = 0; i < 2; ++i) {
    const auto found = world_.named_materials.find(parts[i]);
    if (found == world_.named_materials.end())
      fail(def.at, "a mix of the material ", quote(parts[i]), ", which is not made");
    const Built part = follow(found->second, depth + 1);
    albedos[i] = part.albedo;
    glosses[i] = part.gloss;
    if (!albedos[i]) albedos[i] = gray(0);  // what passes through the surface is not reflected
  }
  const TexturePtr amount = textures_.of_float(params, "amount", 0.5f);
  const TexturePtr albedo = mix_textures(albedos[0], albedos[1], amount, def.at);
  const auto& [a, b] = glosses;
  if (!(a.metallic > 0 || b.metallic > 0)) return {albedo, {}};
  // Surfaces have one color and one roughness, so those of the parts are mixed, too.
  ignored_->add("mix with a metal: colors and roughnesses are mixed, too", def.at);
  const bool constant = amount->kind == TextureNode::Kind::Constant;
  if (!constant) ignored_->add("texture of the amount of metal in a mix: 0.5 taken", def.at);
  const float t = constant ? std::clamp(amount->value.x, 0.0f, 1.0f) : 0.5f;
  const float metal_a = (1 - t) * a.metallic, metal_b = t * b.metallic, sum = metal_a + metal_b;
  if (!(sum > 0)) return {albedo, {}};
  return {albedo, {sum, (metal_a * a.roughness + metal_b * b.roughness) / sum}};
}

MaterialTable::Built MaterialTable::build(const MaterialDef& def, int depth) {
  const Params& params = *def.params;
  if (is_interface(def.type)) {
    ignored_->add("surfaces of the material \"interface\": left out", def.at);
    return {};
  }
  for (const Simple& simple : kSimple) {
    if (simple.type != def.type) continue;
    if (simple.dropped != nullptr)
      ignored_->add(concat("Material ", quote(def.type), ": ", simple.dropped), def.at);
    return {textures_.of(params, std::string(simple.parameter),
                         {simple.fallback, simple.fallback, simple.fallback}),
            {}};
  }
  if (is_metal(def.type)) return metal(def);
  if (def.type == "mix") return mixture(def, depth);
  if (def.type == "dielectric" || def.type == "thindielectric" || def.type == "glass") {
    ignored_->add("Material " + quote(def.type) + ": white and opaque", def.at);
    return {gray(1), {}};
  }
  ignored_->add("unknown Material " + quote(def.type) + ": 0.5 taken", def.at);
  return {gray(0.5f), {}};
}

}  // namespace lte::scene::pbrt
