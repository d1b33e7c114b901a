#include "infer/view/editor.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "infer/view/replies.h"
#include "infer/view/scratch_folder.h"
#include "infer/view/session_scene.h"
#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/text.h"

namespace lte::infer::view {
namespace {

/// What a page can be sent at most.
constexpr size_t kMostSceneBytes = size_t{256} << 20;

bool one_step(const Pending& a, const Pending& b) {
  const auto* first = std::get_if<MakeEdit>(&a.request);
  const auto* second = std::get_if<MakeEdit>(&b.request);
  return first != nullptr && second != nullptr && a.client == b.client && first->gesture != 0 &&
         first->gesture == second->gesture;
}

}  // namespace

Editor::Editor(Session* session, const SceneDescription* scene, Pages* pages,
               std::function<void()> changed)
    : session_(session), scene_(scene), pages_(pages), changed_(std::move(changed)) {
  made_.state = session_->state();
  loaded_ = settings_of(*made_.state, *scene_);
  thread_ = std::thread([this] { run(); });
}

Editor::~Editor() { stop(); }

void Editor::stop() {
  stopping_ = true;
  inbox_.wake();
  if (thread_.joinable()) thread_.join();
}

bool Editor::post(int client, int64_t number, const Request& request) {
  return inbox_.post(client, number, request);
}

Editor::Made Editor::made() const {
  const std::lock_guard lock(mutex_);
  return made_;
}

std::string Editor::scene_text() const {
  return scene_reply(*scene_, settings_of(*made().state, *scene_), undo_steps());
}

UndoSteps Editor::undo_steps() const { return {session_->can_undo(), session_->can_redo()}; }

void Editor::run() {
  while (!stopping_) work(inbox_.take(Inbox::kAnyTime));
}

void Editor::work(const Inbox::Batch& batch) {
  for (size_t first = 0; first < batch.requests.size() && !stopping_;) {
    size_t last = first + 1;
    while (last < batch.requests.size() && one_step(batch.requests[first], batch.requests[last]))
      ++last;
    const int client = batch.requests[first].client;
    try {
      const std::span<const Pending> step = std::span(batch.requests).subspan(first, last - first);
      if (std::holds_alternative<MakeEdit>(step.front().request)) {
        make(step);
      } else if (std::holds_alternative<Save>(step.front().request)) {
        save(client);
      } else {
        turn_back(step.front());
      }
    } catch (const std::exception& error) {
      pages_->tell(client, error_reply(first_line(error.what())));
      pages_->tell(client, scene_text());  // what the page shows already has not happened
    }
    first = last;
  }
  {
    const std::lock_guard lock(mutex_);
    made_ = {session_->state(), batch.last_number};
  }
  changed_();
}

void Editor::make(std::span<const Pending> edits) {
  std::vector<PageEdit> settings;
  for (const Pending& pending : edits) settings.push_back(std::get<MakeEdit>(pending.request).edit);
  const std::pair<int, int64_t> gesture{edits.front().client,
                                        std::get<MakeEdit>(edits.front().request).gesture};
  const bool merge = gesture.second != 0 && gesture == last_gesture_;
  const EditReport report = session_->apply(session_edits(settings, *scene_), merge);
  last_gesture_ = gesture;
  ++steps_;
  pages_->tell_all(edits_reply(gesture.first, settings, cost_of(report), undo_steps()));
}

void Editor::turn_back(const Pending& pending) {
  last_gesture_ = {};
  std::optional<EditReport> report;
  if (std::holds_alternative<Undo>(pending.request)) {
    report = session_->undo();
  } else if (std::holds_alternative<Redo>(pending.request)) {
    report = session_->redo();
  } else {
    return reset();
  }
  if (report) announce(*report);
}

void Editor::reset() {
  const std::vector<PageEdit> now = settings_of(*session_->state(), *scene_);
  std::vector<PageEdit> back;
  for (const PageEdit& setting : loaded_) {
    if (std::find(now.begin(), now.end(), setting) == now.end()) back.push_back(setting);
  }
  if (!back.empty()) announce(session_->apply(session_edits(back, *scene_)));
}

void Editor::announce(const EditReport& report) {
  ++steps_;
  {
    const std::lock_guard lock(mutex_);
    made_.state = session_->state();
  }
  pages_->tell_all(scene_text());
  pages_->tell_all(edits_reply(0, {}, cost_of(report), undo_steps()));
}

void Editor::save(int client) {
  const ScratchFolder folder;
  const std::filesystem::path file = folder.path() / "scene.glb";
  session_->state()->write_glb(file);
  pages_->give(client, std::make_shared<const std::string>(
                           file_frame(scene_->name + "_edited.glb", "model/gltf-binary",
                                      read_file(file, kMostSceneBytes))));
}

}  // namespace lte::infer::view
