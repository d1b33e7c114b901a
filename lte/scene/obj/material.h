// Wavefront MTL: the material file of OBJ.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "lte/scene/import/ignored_features.h"
#include "lte/scene/import/scene_files.h"
#include "lte/scene/scene.h"

namespace lte::scene::obj {

/// The color of what has none, in each channel.
inline constexpr float kDefaultGray = 0.5f;

/// Materials by name, and the pictures that they refer to: TextureRef::texture is an index into
/// `pictures`.
struct MaterialLibrary {
  std::vector<Material> materials;
  std::map<std::string, int> by_name;
  /// Each once, and once more if it serves both as colors (true) and as they stand.
  std::vector<std::pair<SceneFilePtr, bool>> pictures;
};

/// Opens a file that `from` names: where the name leads from there, else beside it. Backslashes
/// divide folders too, and of a path that is absolute or of another machine only the last part is
/// looked for.
/// @param where  file, and line if it is known, for messages
/// @return  null if there is no such file
/// @throws OutsideFolder; see SceneFiles::open().
SceneFilePtr find_beside(const SceneFile& from, const std::string& name, const std::string& where,
                         SceneFiles* files);

/// Adds the materials of one file. Of a name that is given twice, the first one counts. Kd and Ke
/// are linear; Ke is radiance. What a Lambertian surface cannot show is ignored, and recorded once
/// for each material.
/// @throws lte::Error naming file and line: a number that is none, not finite or negative.
void read_mtl(const SceneFile& file, SceneFiles* files, IgnoredFeatures* ignored,
              MaterialLibrary* library);

}  // namespace lte::scene::obj
