#include "infer/session/session.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <mutex>
#include <utility>

#include "infer/session/state.h"
#include "lte/base/check.h"
#include "lte/base/timer.h"

namespace lte::infer {
namespace {

using SceneEditsPtr = std::shared_ptr<const SceneEdits>;

/// The edits with some luminaires encoded apart; itself if they are already.
SceneEditsPtr touched(const SceneEditsPtr& edits, const std::vector<int>& lights) {
  auto out = std::make_shared<SceneEdits>(*edits);
  bool changed = false;
  for (LightSetting& setting : out->settings) {
    const bool wanted = std::find(lights.begin(), lights.end(), setting.label.id) != lights.end();
    if (!wanted || setting.touched || setting.brightness <= 0) continue;
    setting.touched = changed = true;
  }
  return changed ? out : edits;
}

/// What ends the work on a state that nobody waits for any more.
struct Stopped {};

std::function<void()> throwing(const Session::Stop& stop) {
  if (!stop) return {};
  return [&stop] {
    if (stop()) throw Stopped();
  };
}

}  // namespace

EditReport& EditReport::operator+=(const EditReport& next) {
  version = next.version;
  scene_ms += next.scene_ms;
  bvh_ms += next.bvh_ms;
  points_ms += next.points_ms;
  light_ms += next.light_ms;
  encode_ms += next.encode_ms;
  total_ms += next.total_ms;
  encodings += next.encodings;
  layers = next.layers;
  points_drawn += next.points_drawn;
  bvh_rebuilt = bvh_rebuilt || next.bvh_rebuilt;
  accuracy = next.accuracy;
  return *this;
}

struct Session::Implementation {
  std::shared_ptr<const SessionBase> base;
  EditReport first;

  std::mutex editing;  ///< held while a state is made, for seconds; guards `ids`
  NextIds ids;

  mutable std::mutex mutex;  ///< guards what follows, for moments; only edits change it
  StatePtr now;
  std::deque<SceneEditsPtr> before, after;  ///< of undo and redo; the nearest step last
  SceneEditsPtr beginning;

  StatePtr state() const {
    const std::lock_guard lock(mutex);
    return now;
  }

  const SessionState::Parts& parts(const StatePtr& state) const { return state->parts(); }

  /// Makes a state of the edits and puts it in the place of the one of now, and then has the steps
  /// of undo and redo changed.
  template <typename Steps>
  void go_to(SceneEditsPtr edited, const Wanted& wanted, const Timer& timer, EditReport* report,
             const Steps& change_steps) {
    const StatePtr last = state();
    std::unique_ptr<SessionState::Parts> made =
        make_parts(base, std::move(edited), last ? &last->parts() : nullptr, wanted, report);
    StatePtr next(new SessionState(std::move(made)));
    report->total_ms = 1e3 * timer.seconds();
    const std::lock_guard lock(mutex);
    now = std::move(next);
    change_steps();
  }

  /// Goes to the nearest of `steps`, if there is one, and has the edits of before kept.
  template <typename Keep>
  std::optional<EditReport> step(std::deque<SceneEditsPtr>* steps, Accuracy least,
                                 const Keep& keep) {
    const std::lock_guard lock(editing);
    if (steps->empty()) return std::nullopt;
    const Timer timer;
    EditReport report;
    const SceneEditsPtr last = parts(state()).edits;
    go_to(steps->back(), {least}, timer, &report, [&] {
      steps->pop_back();
      keep(last);
    });
    return report;
  }

  void remember(SceneEditsPtr edited) {
    before.push_back(std::move(edited));
    while (before.size() > static_cast<size_t>(std::max(0, base->settings.undo_steps)))
      before.pop_front();
  }
};

Session::Session(scene::Scene scene, std::optional<runtime::Network> network,
                 const SessionSettings& settings)
    : implementation_(std::make_unique<Implementation>()) {
  Implementation& own = *implementation_;
  const Timer timer;
  own.base = std::make_shared<const SessionBase>(std::move(scene), std::move(network), settings);
  own.beginning = std::make_shared<const SceneEdits>(make_edits(own.base->scene, &own.ids));
  own.go_to(own.beginning, {}, timer, &own.first, [] {});
}

Session::~Session() = default;

StatePtr Session::state() const { return implementation_->state(); }
const EditReport& Session::first_report() const { return implementation_->first; }

EditReport Session::apply(std::span<const Edit> edits, bool merge, Accuracy least) {
  Implementation& own = *implementation_;
  const std::lock_guard lock(own.editing);
  const Timer timer;
  EditReport report;
  const SceneEditsPtr last = own.parts(own.state()).edits;
  auto edited = std::make_shared<SceneEdits>(*last);
  for (const Edit& edit : edits) apply_edit(edit, edited.get(), &own.ids, &report);
  own.go_to(std::move(edited), {least}, timer, &report, [&] {
    own.after.clear();
    if (!merge || own.before.empty()) own.remember(last);
  });
  return report;
}

EditReport Session::apply(const Edit& edit, bool merge, Accuracy least) {
  return apply(std::span<const Edit>(&edit, 1), merge, least);
}

std::optional<EditReport> Session::undo(Accuracy least) {
  Implementation& own = *implementation_;
  return own.step(&own.before, least,
                  [&own](SceneEditsPtr last) { own.after.push_back(std::move(last)); });
}

std::optional<EditReport> Session::redo(Accuracy least) {
  Implementation& own = *implementation_;
  return own.step(&own.after, least, [&own](SceneEditsPtr last) { own.remember(std::move(last)); });
}

std::optional<EditReport> Session::reset(Accuracy least) {
  Implementation& own = *implementation_;
  const std::lock_guard lock(own.editing);
  const SceneEditsPtr last = own.parts(own.state()).edits;
  if (same_scene(*last, *own.beginning)) return std::nullopt;
  const Timer timer;
  EditReport report;
  own.go_to(own.beginning, {least}, timer, &report, [&] {
    own.after.clear();
    own.remember(last);
  });
  return report;
}

bool Session::remembers(int instance) const {
  const Implementation& own = *implementation_;
  const auto has = [&](const SceneEditsPtr& edits) {
    return std::any_of(edits->instance_labels.begin(), edits->instance_labels.end(),
                       [&](const Label& label) { return label.id == instance; });
  };
  const std::lock_guard lock(own.mutex);
  return has(own.parts(own.now).edits) || has(own.beginning) ||
         std::any_of(own.before.begin(), own.before.end(), has) ||
         std::any_of(own.after.begin(), own.after.end(), has);
}

bool Session::can_undo() const {
  const std::lock_guard lock(implementation_->mutex);
  return !implementation_->before.empty();
}

bool Session::can_redo() const {
  const std::lock_guard lock(implementation_->mutex);
  return !implementation_->after.empty();
}

std::optional<EditReport> Session::refine(Accuracy to, const Stop& stop) {
  Implementation& own = *implementation_;
  const std::lock_guard lock(own.editing);
  const StatePtr last = own.state();
  if (last->accuracy() >= to) return std::nullopt;
  const Timer timer;
  EditReport report;
  try {
    own.go_to(own.parts(last).edits, {to, throwing(stop)}, timer, &report, [] {});
  } catch (const Stopped&) {
    return std::nullopt;
  }
  return report;
}

std::optional<EditReport> Session::look_from(std::vector<scene::Camera> cameras, Accuracy least,
                                             const Stop& stop) {
  Implementation& own = *implementation_;
  const std::lock_guard lock(own.editing);
  const StatePtr last = own.state();
  const SessionState::Parts& parts = own.parts(last);
  cameras = without_repeats(std::move(cameras));
  if (same_cameras(parts.cameras, cameras)) return std::nullopt;
  const Timer timer;
  EditReport report;
  try {
    own.go_to(parts.edits, {least, throwing(stop), std::move(cameras)}, timer, &report, [] {});
  } catch (const Stopped&) {
    return std::nullopt;
  }
  if (report.version == last->version()) return std::nullopt;
  return report;
}

std::optional<EditReport> Session::separate(std::span<const int> lights, const Stop& stop) {
  Implementation& own = *implementation_;
  const std::lock_guard lock(own.editing);
  const Timer timer;
  EditReport report;
  const SceneEditsPtr last = own.parts(own.state()).edits;
  std::vector<int> wanted(lights.begin(), lights.end());
  for (const int light : wanted) group_of(*last, light);
  if (wanted.empty()) {
    for (const LightSetting& setting : last->settings) wanted.push_back(setting.label.id);
  }
  try {
    own.go_to(touched(last, wanted), {Accuracy::Full, throwing(stop)}, timer, &report, [&] {
      own.beginning = touched(own.beginning, wanted);
      for (std::deque<SceneEditsPtr>* steps : {&own.before, &own.after}) {
        for (SceneEditsPtr& step : *steps) step = touched(step, wanted);
      }
    });
  } catch (const Stopped&) {
    return std::nullopt;
  }
  return report;
}

}  // namespace lte::infer
