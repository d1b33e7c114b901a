// Plays a script of edits on a session, frame by frame.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "infer/render/edit_script.h"
#include "infer/session/session.h"

namespace lte::infer {

class EditPlayer {
 public:
  /// Both must outlive it.
  EditPlayer(const EditScript& script, Session* session) : script_(script), session_(*session) {}

  /// Brings the session to a frame, which is no less than the one before. The state depends on the
  /// frame alone, not on which frames were left out on the way.
  /// @return  the sum of what was redone
  /// @throws lte::Error naming the place in the file
  EditReport go_to(int frame);

 private:
  /// Where an instance was before its tracks moved it.
  struct Place {
    Affine to_world;
    Vec3 middle;
  };
  void happen(const EditEvent& event, EditReport* report);
  void play_tracks(int frame, EditReport* report);
  void add_tracks(int frame, std::vector<Edit>* edits);
  Affine place_of(int instance, const std::map<TrackProperty, std::vector<double>>& values);

  const EditScript& script_;
  Session& session_;
  size_t next_event_ = 0;
  std::map<int, Place> places_;
  std::set<std::string> removed_;               ///< names whose tracks have ended
  std::map<size_t, std::vector<double>> last_;  ///< of each track, as applied
};

/// Plays the keys of a script without light or pictures, so that what it asks for and cannot be is
/// known before the first frame.
/// @throws lte::Error as EditPlayer::go_to()
void rehearse(const EditScript& script, const scene::Scene& scene);

}  // namespace lte::infer
