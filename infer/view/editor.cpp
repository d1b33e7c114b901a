#include "infer/view/editor.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>

#include "infer/session/scene_edits.h"
#include "infer/view/replies.h"
#include "infer/view/session_scene.h"
#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/scratch_folder.h"
#include "lte/base/text.h"

namespace lte::infer::view {
namespace {

/// What a page can be sent at most.
constexpr size_t kMaxSceneBytes = size_t{256} << 20;
/// Without a request, before all light of an edit is found.
constexpr std::chrono::milliseconds kEditsRest(150);
/// While edits follow one another, the light follows at least so often.
constexpr double kLightSeconds = 0.4;

bool one_step(const Pending& a, const Pending& b) {
  const auto* first = std::get_if<MakeEdit>(&a.request);
  const auto* second = std::get_if<MakeEdit>(&b.request);
  return first != nullptr && second != nullptr && a.client == b.client && first->gesture != 0 &&
         first->gesture == second->gesture;
}

}  // namespace

Editor::Editor(Session* session, Pages* pages, std::function<void()> changed)
    : session_(session), pages_(pages), changed_(std::move(changed)) {
  made_.state = session_->state();
  objects_ = list_objects(*made_.state);
  next_ = next_after(*made_.state);
  describe();
}

Editor::~Editor() { stop(); }

void Editor::start() {
  thread_ = std::thread([this] { run(); });
}

void Editor::stop() {
  stopping_ = true;
  inbox_.wake();
  if (thread_.joinable()) thread_.join();
}

bool Editor::post(int client, int64_t number, const Request& request) {
  return inbox_.post(client, number, request);
}

/// Wakes nobody who works: what is under way goes on, and the camera comes next.
void Editor::look_from(const scene::Camera& camera) {
  {
    const std::lock_guard lock(mutex_);
    camera_ = camera;
  }
  if (idle_) inbox_.wake();
}

bool Editor::camera_waits() const {
  const std::lock_guard lock(mutex_);
  return camera_.has_value();
}

std::optional<scene::Camera> Editor::take_camera() {
  const std::lock_guard lock(mutex_);
  return std::exchange(camera_, std::nullopt);
}

Editor::Made Editor::made() const {
  const std::lock_guard lock(mutex_);
  return made_;
}

std::string Editor::scene_text() const {
  const Made now = made();
  return scene_reply(*now.scene, settings_of(*now.state, *now.scene), undo_steps());
}

UndoSteps Editor::undo_steps() const { return {session_->can_undo(), session_->can_redo()}; }

/// Lists the scene anew, and forgets objects that cannot come back.
void Editor::describe() {
  std::erase_if(objects_, [&](const ObjectDescription& object) {
    return std::none_of(object.instances.begin(), object.instances.end(),
                        [&](const int id) { return session_->remembers(id); });
  });
  const StatePtr state = session_->state();
  auto scene = std::make_shared<const SceneDescription>(describe_scene(*state, objects_));
  const std::lock_guard lock(mutex_);
  made_.state = state;
  made_.scene = std::move(scene);
}

/// @param handled  messages that are in the state of now; null for those before
void Editor::publish(const std::map<int, int64_t>* handled) {
  const StatePtr state = session_->state();
  {
    const std::lock_guard lock(mutex_);
    made_.state = state;
    if (handled != nullptr) made_.handled = *handled;
    made_.settled = next_ == Next::Nothing || next_ == Next::Separation;
  }
  changed_();
}

Editor::Next Editor::next_after(const SessionState& state) const {
  if (state.accuracy() == Accuracy::Kept) return Next::DraftLight;
  if (state.accuracy() == Accuracy::Coarse) return Next::FullLight;
  if (!state.answered_by()) return Next::Nothing;  // paths: no lamp is dimmed sooner for it
  const std::vector<LuminaireInfo> lights = state.luminaires();
  const auto shines = [](const LuminaireInfo& light) { return light.brightness > 0; };
  const auto open = [&](const LuminaireInfo& light) { return shines(light) && !light.touched; };
  return std::count_if(lights.begin(), lights.end(), shines) <= kMaxApart &&
                 std::any_of(lights.begin(), lights.end(), open)
             ? Next::Separation
             : Next::Nothing;
}

void Editor::run() {
  while (!stopping_) {
    // A hand that never rests sees new light all the same.
    const bool due = is_light_due();
    idle_ = next_ == Next::Nothing;  // before it is known whether a camera is there
    const bool now = due || next_ == Next::DraftLight || camera_waits();
    const auto wait = now ? Inbox::kNoWait : idle_ ? Inbox::kAnyTime : kEditsRest;
    const Inbox::Batch batch = due ? Inbox::Batch() : inbox_.take(wait);
    idle_ = false;
    if (stopping_) return;
    if (batch.requests.empty()) {
      improve();
    } else {
      work(batch);
    }
  }
}

void Editor::work(const Inbox::Batch& batch) {
  for (size_t first = 0; first < batch.requests.size() && !stopping_;) {
    size_t last = first + 1;
    while (last < batch.requests.size() && one_step(batch.requests[first], batch.requests[last]))
      ++last;
    const int client = batch.requests[first].client;
    try {
      answer(std::span(batch.requests).subspan(first, last - first));
    } catch (const std::exception& error) {
      pages_->tell(client, error_reply(first_line(error.what())));
      pages_->tell(client, scene_text());  // what the page shows already has not happened
    }
    first = last;
  }
  const Next next = next_after(*session_->state());
  if (next == Next::DraftLight && next_ != Next::DraftLight) kept_.restart();
  next_ = next;
  publish(&batch.last_number);
}

bool Editor::is_light_due() const {
  return next_ == Next::DraftLight && kept_.seconds() > kLightSeconds;
}

void Editor::answer(std::span<const Pending> step) {
  const Request& request = step.front().request;
  if (is_any<MakeEdit>(request)) return make(step);
  if (is_any<Save>(request)) return save(step.front().client);
  last_gesture_ = {};
  if (is_any<Undo, Redo, Reset>(request)) return turn_back(step.front());
  restructure(step.front());
}

void Editor::make(std::span<const Pending> edits) {
  std::vector<PageEdit> settings;
  for (const Pending& pending : edits) settings.push_back(std::get<MakeEdit>(pending.request).edit);
  const std::pair<int, int64_t> gesture{edits.front().client,
                                        std::get<MakeEdit>(edits.front().request).gesture};
  const bool merge = gesture.second != 0 && gesture == last_gesture_;
  const EditReport report =
      session_->apply(session_edits(settings, *made().scene), merge, Accuracy::Kept);
  last_gesture_ = gesture;
  ++steps_;
  pages_->tell_all(edits_reply(gesture.first, settings, cost_of(report), undo_steps()));
}

/// Adds or removes something.
void Editor::restructure(const Pending& pending) {
  const Made before = made();
  const EditReport report =
      session_->apply(session_edits(pending.request, *session_->state(), *before.scene),
                      /*merge=*/false, Accuracy::Kept);
  Added added;
  if (const auto* copy = std::get_if<CopyObject>(&pending.request)) {
    std::vector<std::string> taken;
    std::string name;
    for (const ObjectDescription& object : objects_) {
      taken.push_back(object.name);
      if (object.id == copy->object) name = object.name;
    }
    objects_.push_back(
        describe_object(*session_->state(), report.added_instances, unused_name(name, taken)));
    added.object = objects_.back().id;
  } else if (std::holds_alternative<AddLamp>(pending.request)) {
    added.light = report.added_lights.front();
  }
  announce(report);
  if (added.object >= 0 || added.light >= 0) pages_->tell(pending.client, added_reply(added));
}

void Editor::turn_back(const Pending& pending) {
  std::optional<EditReport> report;
  if (std::holds_alternative<Undo>(pending.request)) {
    report = session_->undo(Accuracy::Kept);
  } else if (std::holds_alternative<Redo>(pending.request)) {
    report = session_->redo(Accuracy::Kept);
  } else {
    report = session_->reset(Accuracy::Kept);
  }
  if (report) announce(*report);
}

void Editor::announce(const EditReport& report) {
  ++steps_;
  describe();
  pages_->tell_all(scene_text());
  pages_->tell_all(edits_reply(0, {}, cost_of(report), undo_steps()));
}

/// Does what is next while no request waits.
void Editor::improve() {
  const auto stop = [this] { return stopping_ || (inbox_.waiting() && !is_light_due()); };
  std::optional<EditReport> report;
  try {
    const std::optional<scene::Camera> camera = take_camera();
    if (camera) {
      report = look(*camera, stop);
    } else if (next_ == Next::DraftLight) {
      report = session_->refine(Accuracy::Coarse, stop);
    } else if (next_ == Next::FullLight) {
      report = session_->refine(Accuracy::Full, stop);
    } else if (next_ == Next::Separation) {
      report = session_->separate({}, stop);
    }
    if (!report) return;  // something else comes first
    if (camera || next_ != Next::Separation)
      pages_->tell_all(edits_reply(0, {}, cost_of(*report), undo_steps()));
    next_ = next_after(*session_->state());
  } catch (const std::exception& error) {  // memory, most likely: the light stays as it is
    next_ = Next::Nothing;
    pages_->tell_all(error_reply(first_line(error.what())));
  }
  publish(nullptr);
}

/// SceneEdits light, as after an edit: what comes in sight is soon lit.
std::optional<EditReport> Editor::look(const scene::Camera& camera, const Session::Stop& stop) {
  auto report = session_->look_from({camera}, Accuracy::Coarse, stop);
  if (report || !stop()) return report;
  const std::lock_guard lock(mutex_);  // perhaps it was ended: once more, unless another has come
  if (!camera_) camera_ = camera;
  return report;
}

void Editor::save(int client) {
  const ScratchFolder folder;
  const std::filesystem::path file = folder.path() / "scene.glb";
  session_->state()->write_glb(file);
  pages_->give(client, std::make_shared<const std::string>(
                           file_frame(made().scene->name + "_edited.glb", "model/gltf-binary",
                                      read_file(file, kMaxSceneBytes))));
}

}  // namespace lte::infer::view
