// Wavefront MTL: the material file of OBJ.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "lte/scene/import/ignored_features.h"
#include "lte/scene/scene.h"

namespace lte::scene::obj {

/// Materials by name, and the pictures that they refer to: TextureRef::texture is an index into
/// `pictures`.
struct MaterialLibrary {
  std::vector<Material> materials;
  std::map<std::string, int> by_name;
  std::vector<std::filesystem::path> pictures;  ///< each once; all of them exist
};

/// A file that a scene names, beside the scene or below it. Backslashes divide folders too, and of
/// a path that is absolute or of another machine only the last part is looked for.
/// @return  an empty path if there is no such file
std::filesystem::path find_beside(const std::filesystem::path& scene, const std::string& name);

/// Adds the materials of one file. Of a name that is given twice, the first one counts. Kd and Ke
/// are linear; Ke is radiance. What a Lambertian surface cannot show is ignored, and recorded once
/// for each material.
/// @throws lte::Error naming file and line: a number that is none, not finite or negative.
void read_mtl(const std::filesystem::path& path, IgnoredFeatures* ignored,
              MaterialLibrary* library);

}  // namespace lte::scene::obj
