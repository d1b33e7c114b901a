#include "lte/scene/pbrt_material.h"

#include <array>
#include <string_view>

#include "lte/scene/pbrt_spectrum.h"

namespace lte::scene::pbrt {
namespace {

constexpr int kMaxDepth = 16;  ///< mixtures of mixtures

/// A material whose albedo is one parameter.
struct Simple {
  std::string_view type, parameter;
  float fallback;       ///< pbrt's default
  const char* dropped;  ///< what is left out, for the notes; nullptr for nothing
};

constexpr std::array<Simple, 14> kSimple = {{
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
    {"mirror", "Kr", 0.9f, "a pbrt-v3 material, diffuse with Kr"},
    {"disney", "color", 0.5f, "a pbrt-v3 material, its color taken"},
    {"measured", "reflectance", 0.5f, "diffuse with 0.5"},
}};

bool is_interface(const std::string& type) {
  return type.empty() || type == "interface" || type == "none";
}

TexturePtr grey(float value) { return constant_texture({value, value, value}); }

}  // namespace

TexturePtr MaterialTable::follow(int index, int depth) {
  const MaterialDef& def = world_.materials[static_cast<size_t>(index)];
  if (!def.params) fail(def.at, "no material ", quote(def.name), " is made");
  const auto found = built_.find(index);
  if (found != built_.end()) return found->second;
  if (depth > kMaxDepth) fail(def.at, "mixtures of materials nested deeper than ", kMaxDepth);
  TexturePtr out = build(def, depth);
  note_unused(*def.params, notes_);
  built_[index] = out;
  return out;
}

TexturePtr MaterialTable::conductor(const Params& params, const std::string& prefix) {
  if (params.has("reflectance")) return textures_.of(params, "reflectance", {1, 1, 1});
  const Parameter *eta = params.find(prefix + "eta"), *k = params.find(prefix + "k");
  for (const Parameter* parameter : {eta, k}) {
    if (parameter == nullptr || !parameter->is_texture()) continue;
    notes_->add("texture of a conductor's eta or k, 0.5 taken", parameter->at);
    return grey(0.5f);
  }
  if (eta == nullptr && k == nullptr) return constant_texture(*named_conductor("Cu"));
  return constant_texture(to_conductor(eta, k, files_, notes_));
}

TexturePtr MaterialTable::mixture(const MaterialDef& def, int depth) {
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
  for (size_t i = 0; i < 2; ++i) {
    const auto found = world_.named_materials.find(parts[i]);
    if (found == world_.named_materials.end())
      fail(def.at, "a mix of the material ", quote(parts[i]), ", which is not made");
    albedos[i] = follow(found->second, depth + 1);
    if (!albedos[i]) albedos[i] = grey(0);  // what passes through the surface is not reflected
  }
  return mix_textures(albedos[0], albedos[1], textures_.of_float(params, "amount", 0.5f), def.at);
}

TexturePtr MaterialTable::build(const MaterialDef& def, int depth) {
  const Params& params = *def.params;
  if (is_interface(def.type)) {
    notes_->add("surfaces of the material \"interface\": left out", def.at);
    return nullptr;
  }
  for (const Simple& simple : kSimple) {
    if (simple.type != def.type) continue;
    if (simple.dropped != nullptr)
      notes_->add(concat("Material ", quote(def.type), ": ", simple.dropped), def.at);
    return textures_.of(params, std::string(simple.parameter),
                        {simple.fallback, simple.fallback, simple.fallback});
  }
  if (def.type == "conductor" || def.type == "coatedconductor" || def.type == "metal") {
    notes_->add("Material " + quote(def.type) +
                    ": diffuse with its reflectance at normal incidence, roughness left out",
                def.at);
    for (const char* roughness : {"roughness", "uroughness", "vroughness", "remaproughness"})
      params.has(roughness);
    return conductor(params, def.type == "coatedconductor" ? "conductor." : "");
  }
  if (def.type == "mix") return mixture(def, depth);
  if (def.type == "dielectric" || def.type == "thindielectric" || def.type == "glass") {
    notes_->add("Material " + quote(def.type) + ": white and opaque", def.at);
    return grey(1);
  }
  notes_->add("unknown Material " + quote(def.type) + ": 0.5 taken", def.at);
  return grey(0.5f);
}

}  // namespace lte::scene::pbrt
