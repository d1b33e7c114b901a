// Edits with frames, as --edit reads them: an animation of a scene's lamps, objects and colors.
// docs/editing.md has the format.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lte/scene/scene.h"

namespace lte::infer {

/// What of a scene a track changes, and how many numbers that takes.
enum class TrackProperty {
  Gain,       ///< 1: of a light
  Color,      ///< 3: of a light
  Position,   ///< 3: of a light that is no surface
  Direction,  ///< 3: likewise
  Move,       ///< 3: metres by which an instance is moved from its place in the file
  Turn,   ///< 1: degrees about +Y through the middle of its bounds, counter-clockwise from above
  Scale,  ///< 1: factor about that middle
  BaseColor,  ///< 3: of a material
};

/// A value that changes from frame to frame: linear between keys, constant behind the last one.
/// Before the first it does nothing.
struct EditTrack {
  std::string where;   ///< "edits.yaml:12", for messages
  std::string target;  ///< name of the light, instance or material
  TrackProperty property = TrackProperty::Gain;
  std::vector<int> frames;                  ///< growing, an entry a key
  std::vector<std::vector<double>> values;  ///< an entry a key

  std::vector<double> at(double frame) const;
};

/// Something that happens once, before the picture of its frame.
struct EditEvent {
  enum class Kind { AddLight, AddInstance, RemoveLight, RemoveInstance, SetEnvironment };
  std::string where;
  Kind kind = Kind::AddLight;
  int frame = 0;
  std::string target;          ///< what is removed, or what a new instance is like
  Vec3 move;                   ///< AddInstance: from the place of what it is like
  scene::PunctualLight light;  ///< AddLight
  std::string environment;     ///< "1,1,1", a picture, or "none"
};

struct EditScript {
  int frames = 1;   ///< pictures
  double fps = 24;  ///< of a video
  std::vector<EditTrack> tracks;
  std::vector<EditEvent> events;  ///< by frame
};

/// @param name  stands for the file in messages
/// @throws lte::Error of one line naming file, line and key
EditScript parse_edit_script(const std::string& text, const std::string& name);
EditScript load_edit_script(const std::filesystem::path& path);

}  // namespace lte::infer
