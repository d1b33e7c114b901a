// Atlases of tests.
#pragma once

#include "lte/bake/atlas.h"

namespace lte::bake {

inline AtlasOptions density(double texels_per_metre) {
  AtlasOptions out;
  out.texels_per_metre = texels_per_metre;
  return out;
}

}  // namespace lte::bake
