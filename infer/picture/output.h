// What a picture shows, and who answers for it.
#pragma once

#include "lte/base/enum_names.h"

namespace lte::infer {

enum class Output {
  Full,
  Gi,
  Irradiance,
  Direct,
  Albedo,
  Normal,
  Depth,
  Attention  ///< what the network looks at (attention_map.h); its picture is painted on surfaces
};
enum class Mode { Neural, Reference };
/// How indirect light is made in neural mode.
enum class Indirect {
  Decoded,  ///< the network's decoder answers at each pixel
  Paths,
  Gather  ///< rays that read a table of the light on surfaces (light_table.h)
};
/// What stands in a picture for metal, which an irradiance decoder does not know.
enum class Metal {
  Diffuse,  ///< a matt surface of its color
  Black,    ///< nothing: the matt share of the surface alone is lit
  Trace,    ///< the path tracer renders pixels that have metal in them
  Network,  ///< the same of their direct light; a radiance decoder answers for later bounces
};

constexpr EnumNames<Output, 8> enum_names(Output) {
  return {{{Output::Full, "full"},
           {Output::Gi, "gi"},
           {Output::Irradiance, "irradiance"},
           {Output::Direct, "direct"},
           {Output::Albedo, "albedo"},
           {Output::Normal, "normal"},
           {Output::Depth, "depth"},
           {Output::Attention, "attention"}}};
}
constexpr EnumNames<Mode, 2> enum_names(Mode) {
  return {{{Mode::Neural, "neural"}, {Mode::Reference, "reference"}}};
}
constexpr EnumNames<Indirect, 3> enum_names(Indirect) {
  return {
      {{Indirect::Decoded, "decoded"}, {Indirect::Gather, "gather"}, {Indirect::Paths, "paths"}}};
}

constexpr EnumNames<Metal, 4> enum_names(Metal) {
  return {{{Metal::Diffuse, "diffuse"},
           {Metal::Black, "black"},
           {Metal::Trace, "trace"},
           {Metal::Network, "network"}}};
}

/// Whether there is no light in it.
constexpr bool is_geometry(Output output) {
  return output == Output::Albedo || output == Output::Normal || output == Output::Depth ||
         output == Output::Attention;
}

}  // namespace lte::infer
