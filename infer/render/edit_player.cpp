#include "infer/render/edit_player.h"

#include <cmath>
#include <utility>

#include "lte/base/check.h"
#include "lte/scene/import/environment_file.h"

namespace lte::infer {
namespace {

Vec3 vector_at(const std::vector<double>& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

/// Runs `body`, and puts the place in the file before what it throws.
template <typename Body>
auto at_place(const std::string& where, const Body& body) {
  try {
    return body();
  } catch (const Error& error) {
    throw Error(concat(where, ": ", error.what()));
  }
}

const InstanceInfo& info_of(const std::vector<InstanceInfo>& instances, int id) {
  for (const InstanceInfo& info : instances) {
    if (info.id == id) return info;
  }
  throw Error(concat("there is no instance of the number ", id));
}

Affine shift(const Vec3& by) {
  Affine out;
  for (int i = 0; i < 3; ++i) out.m[i][3] = by[i];
  return out;
}

/// Turns about +Y, and scales.
Affine turn(double degrees, double scale) {
  const double angle = degrees * M_PI / 180;
  const auto c = static_cast<float>(scale * std::cos(angle)),
             s = static_cast<float>(scale * std::sin(angle));
  Affine out;
  out.m[0] = {c, 0, s, 0};
  out.m[1] = {0, static_cast<float>(scale), 0, 0};
  out.m[2] = {-s, 0, c, 0};
  return out;
}

}  // namespace

void EditPlayer::happen(const EditEvent& event, EditReport* report) {
  // A copy stands beside where what it is like is at that moment.
  if (event.kind == EditEvent::Kind::AddInstance) play_tracks(event.frame, report);
  const StatePtr state = session_.state();
  const auto edit = [&]() -> Edit {
    switch (event.kind) {
      case EditEvent::Kind::AddLight:
        return AddLight{event.light};
      case EditEvent::Kind::AddInstance: {
        const int like = state->find_instance(event.target);
        return AddInstance{like, shift(event.move) * info_of(state->instances(), like).to_world};
      }
      case EditEvent::Kind::RemoveLight:
        return RemoveLight{state->find_luminaire(event.target)};
      case EditEvent::Kind::RemoveInstance:
        return RemoveInstance{state->find_instance(event.target)};
      default: {
        if (event.environment == "none") return SetEnvironment{};
        scene::Scene made;
        scene::set_environment(event.environment, 0, &made);
        return SetEnvironment{made.environment};
      }
    }
  };
  *report += at_place(event.where, [&] { return session_.apply(edit()); });
  if (event.kind == EditEvent::Kind::RemoveLight || event.kind == EditEvent::Kind::RemoveInstance)
    removed_.insert(event.target);
}

Affine EditPlayer::place_of(int instance,
                            const std::map<TrackProperty, std::vector<double>>& values) {
  const auto [found, is_new] = places_.emplace(instance, Place{});
  Place& place = found->second;
  if (is_new) {
    const std::vector<InstanceInfo> instances = session_.state()->instances();
    const InstanceInfo& info = info_of(instances, instance);
    place = {info.to_world, info.bounds.empty() ? Vec3{} : info.bounds.center()};
  }
  const auto value = [&](TrackProperty property, double otherwise) {
    const auto given = values.find(property);
    return given == values.end() ? otherwise : given->second[0];
  };
  const auto move = values.find(TrackProperty::Move);
  const Vec3 by = move == values.end() ? Vec3{} : vector_at(move->second);
  const double degrees = value(TrackProperty::Turn, 0), scale = value(TrackProperty::Scale, 1);
  // A plain shift keeps every bit of the rotation.
  if (degrees == 0 && scale == 1) return shift(by) * place.to_world;
  return shift(by + place.middle) * turn(degrees, scale) * shift(-place.middle) * place.to_world;
}

void EditPlayer::add_tracks(int frame, std::vector<Edit>* edits) {
  const StatePtr state = session_.state();
  std::map<int, std::map<TrackProperty, std::vector<double>>> placed;
  std::map<int, bool> changed;
  for (size_t k = 0; k < script_.tracks.size(); ++k) {
    const EditTrack& track = script_.tracks[k];
    if (frame < track.frames.front() || removed_.contains(track.target)) continue;
    const std::vector<double> value = track.at(frame);
    const bool same = last_.contains(k) && last_[k] == value;
    last_[k] = value;
    at_place(track.where, [&] {
      switch (track.property) {
        case TrackProperty::Move:
        case TrackProperty::Turn:
        case TrackProperty::Scale: {
          const int id = state->find_instance(track.target);
          placed[id][track.property] = value;
          changed[id] = changed[id] || !same;
          return;
        }
        case TrackProperty::BaseColor: {
          const int id = state->find_material(track.target);
          if (!same) edits->push_back(SetMaterial{id, vector_at(value)});
          return;
        }
        default:
          break;
      }
      const int id = state->find_luminaire(track.target);
      if (same) return;
      if (track.property == TrackProperty::Gain) edits->push_back(SetLight{id, value[0], {}});
      if (track.property == TrackProperty::Color)
        edits->push_back(SetLight{id, {}, vector_at(value)});
      if (track.property == TrackProperty::Position)
        edits->push_back(MoveLight{id, vector_at(value), {}});
      if (track.property == TrackProperty::Direction)
        edits->push_back(MoveLight{id, {}, vector_at(value)});
    });
  }
  for (const auto& [id, values] : placed) {
    if (changed[id]) edits->push_back(MoveInstance{id, place_of(id, values)});
  }
}

void EditPlayer::play_tracks(int frame, EditReport* report) {
  std::vector<Edit> edits;
  add_tracks(frame, &edits);
  if (edits.empty()) return;
  const std::string& line = script_.tracks.front().where;
  // Which of them is refused the message says by its name.
  *report += at_place(line.substr(0, line.rfind(':')), [&] { return session_.apply(edits); });
}

EditReport EditPlayer::go_to(int frame) {
  EditReport report;
  for (; next_event_ < script_.events.size() && script_.events[next_event_].frame <= frame;
       ++next_event_)
    happen(script_.events[next_event_], &report);
  play_tracks(frame, &report);
  return report;
}

void rehearse(const EditScript& script, const scene::Scene& scene) {
  std::set<int> keys;
  for (const EditTrack& track : script.tracks)
    keys.insert(track.frames.begin(), track.frames.end());
  for (const EditEvent& event : script.events) keys.insert(event.frame);
  Session session(scene, std::nullopt);
  EditPlayer player(script, &session);
  for (const int frame : keys) player.go_to(frame);
}

}  // namespace lte::infer
