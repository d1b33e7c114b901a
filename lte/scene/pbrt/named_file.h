// Meshes and pictures in files that a line of a PBRT scene names.
#pragma once

#include "lte/image/picture.h"
#include "lte/scene/import/scene_files.h"
#include "lte/scene/pbrt/source.h"

namespace lte::scene::pbrt {

/// Runs `read`; what goes wrong with the file is reported at the line that names it.
template <typename Read>
auto at_line(const Location& at, const Read& read) {
  try {
    return read();
  } catch (const Error& error) {
    const bool refused = dynamic_cast<const LimitError*>(&error) != nullptr;
    if (at.file != nullptr && at.file->outside && !refused)
      fail(at, "the file that it names cannot be read");
    rethrow_at(concat(at), error);
  }
}

/// The size that the picture's header gives.
inline image::DeclaredSize declared_size(const SceneFile& file, const Location& at) {
  return at_line(at, [&] {
    return read_discreetly(file, "picture",
                           [&] { return image::read_picture_size(file.text(), file.name()); });
  });
}

inline image::Picture decode_picture(const SceneFile& file, const Location& at,
                                     int64_t limit_pixels) {
  return at_line(at, [&] {
    return read_discreetly(file, "picture", [&] {
      return image::decode_picture(file.text(), file.name(), limit_pixels);
    });
  });
}

}  // namespace lte::scene::pbrt
