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

using DraftPtr = std::shared_ptr<const Draft>;

int64_t bytes_of(const scene::Scene& scene) {
  size_t bytes = 0;
  for (const scene::Mesh& mesh : scene.meshes) {
    bytes += mesh.positions.size() * sizeof(Vec3) +
             mesh.triangles.size() * sizeof(mesh.triangles[0]) + mesh.colors.size() * sizeof(Rgb);
    for (const std::vector<Vec2>& uvs : mesh.uvs) bytes += uvs.size() * sizeof(Vec2);
  }
  return static_cast<int64_t>(bytes);
}

/// The draft with some luminaires encoded apart; itself if they are already.
DraftPtr touched(const DraftPtr& draft, const std::vector<int>& lights) {
  auto out = std::make_shared<Draft>(*draft);
  bool changed = false;
  for (LightSetting& setting : out->settings) {
    const bool wanted = std::find(lights.begin(), lights.end(), setting.label.id) != lights.end();
    if (!wanted || setting.touched || setting.brightness <= 0) continue;
    setting.touched = changed = true;
  }
  return changed ? out : draft;
}

}  // namespace

struct Session::Implementation {
  std::shared_ptr<const SessionBase> base;
  EditReport first;
  std::shared_ptr<const int> alive = std::make_shared<const int>(0);

  std::mutex edits;  ///< held while a state is made, for seconds; guards `ids`
  NextIds ids;

  mutable std::mutex mutex;  ///< guards what follows, for moments; only edits change it
  StatePtr now;
  std::deque<DraftPtr> before, after;  ///< of undo and redo; the nearest step last

  StatePtr state() const {
    const std::lock_guard lock(mutex);
    return now;
  }

  const SessionState::Parts& parts(const StatePtr& state) const { return state->parts(); }

  /// Makes a state of the draft and puts it in the place of the one of now, and then has the steps
  /// of undo and redo changed.
  template <typename Steps>
  void go_to(DraftPtr draft, const Timer& timer, EditReport* report, const Steps& change_steps) {
    const StatePtr last = state();
    std::unique_ptr<SessionState::Parts> made =
        make_parts(base, std::move(draft), last ? &last->parts() : nullptr, report);
    made->alive = alive;
    StatePtr next(new SessionState(std::move(made)));
    report->total_ms = 1e3 * timer.seconds();
    const std::lock_guard lock(mutex);
    now = std::move(next);
    change_steps();
  }

  void remember(DraftPtr draft) {
    before.push_back(std::move(draft));
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
  auto draft = std::make_shared<Draft>(make_draft(own.base->scene, &own.ids));
  own.go_to(std::move(draft), timer, &own.first, [] {});
}

Session::~Session() = default;

StatePtr Session::state() const { return implementation_->state(); }
const EditReport& Session::first_report() const { return implementation_->first; }

EditReport Session::apply(std::span<const Edit> edits, bool merge) {
  Implementation& own = *implementation_;
  const std::lock_guard lock(own.edits);
  const Timer timer;
  EditReport report;
  const DraftPtr last = own.parts(own.state()).draft;
  auto draft = std::make_shared<Draft>(*last);
  for (const Edit& edit : edits) apply_edit(edit, draft.get(), &own.ids, &report);
  own.go_to(std::move(draft), timer, &report, [&] {
    own.after.clear();
    if (!merge || own.before.empty()) own.remember(last);
  });
  return report;
}

EditReport Session::apply(const Edit& edit, bool merge) {
  return apply(std::span<const Edit>(&edit, 1), merge);
}

std::optional<EditReport> Session::undo() {
  Implementation& own = *implementation_;
  const std::lock_guard lock(own.edits);
  if (own.before.empty()) return std::nullopt;
  const Timer timer;
  EditReport report;
  const DraftPtr last = own.parts(own.state()).draft;
  own.go_to(own.before.back(), timer, &report, [&] {
    own.before.pop_back();
    own.after.push_back(last);
  });
  return report;
}

std::optional<EditReport> Session::redo() {
  Implementation& own = *implementation_;
  const std::lock_guard lock(own.edits);
  if (own.after.empty()) return std::nullopt;
  const Timer timer;
  EditReport report;
  const DraftPtr last = own.parts(own.state()).draft;
  own.go_to(own.after.back(), timer, &report, [&] {
    own.after.pop_back();
    own.remember(last);
  });
  return report;
}

bool Session::can_undo() const {
  const std::lock_guard lock(implementation_->mutex);
  return !implementation_->before.empty();
}

bool Session::can_redo() const {
  const std::lock_guard lock(implementation_->mutex);
  return !implementation_->after.empty();
}

EditReport Session::separate(std::span<const int> lights) {
  Implementation& own = *implementation_;
  const std::lock_guard lock(own.edits);
  const Timer timer;
  EditReport report;
  const DraftPtr last = own.parts(own.state()).draft;
  std::vector<int> wanted(lights.begin(), lights.end());
  for (const int light : wanted) group_of(*last, light);
  if (wanted.empty()) {
    for (const LightSetting& setting : last->settings) wanted.push_back(setting.label.id);
  }
  own.go_to(touched(last, wanted), timer, &report, [&] {
    for (std::deque<DraftPtr>* steps : {&own.before, &own.after}) {
      for (DraftPtr& step : *steps) step = touched(step, wanted);
    }
  });
  return report;
}

AnswerChange Session::change_against_fresh(const runtime::QueryPoints& queries) const {
  const Implementation& own = *implementation_;
  const StatePtr state = own.state();
  const std::vector<Rgb> here = state->irradiance(queries);
  EditReport ignored;
  const SessionState::Parts& parts = own.parts(state);
  const auto base =
      std::make_shared<const SessionBase>(own.base->scene, own.base->network, own.base->settings);
  const std::vector<Rgb> fresh = make_parts(base, parts.draft, nullptr, &ignored)->answer(queries);
  AnswerChange change;
  double sum = 0;
  for (size_t i = 0; i < here.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      change.largest = std::max(change.largest, std::fabs(double{here[i][c]} - fresh[i][c]));
      sum += double{fresh[i][c]} / (3.0 * static_cast<double>(here.size()));
    }
  }
  change.relative = sum > 0 ? change.largest / sum : change.largest;
  return change;
}

SessionMemory Session::memory() const {
  const Implementation& own = *implementation_;
  SessionMemory out;
  const StatePtr state = own.state();
  const SessionState::Parts& parts = own.parts(state);
  out.scene_bytes = bytes_of(*parts.scene);
  for (const ScaledLayer& each : parts.layers)
    out.embedding_bytes += each.layer->embedding->info().bytes;
  out.states = own.alive.use_count() - 1;
  const std::lock_guard lock(own.mutex);
  out.undo_steps = static_cast<int64_t>(own.before.size());
  out.redo_steps = static_cast<int64_t>(own.after.size());
  for (const std::deque<DraftPtr>* steps : {&own.before, &own.after}) {
    for (const DraftPtr& step : *steps) out.undo_bytes += step->bytes();
  }
  return out;
}

}  // namespace lte::infer
