// The edits of all pages, made one after another in a thread of their own: the camera moves on
// while a scene is encoded anew.
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <mutex>
#include <span>
#include <thread>
#include <utility>
#include <vector>

#include "infer/session/session.h"
#include "infer/view/inbox.h"
#include "infer/view/pages.h"
#include "infer/view/scene_description.h"

namespace lte::infer::view {

class Editor {
 public:
  /// All must outlive the editor.
  /// @param changed  called by the editor's thread when there is a new state
  Editor(Session* session, const SceneDescription* scene, Pages* pages,
         std::function<void()> changed);
  ~Editor();
  Editor(const Editor&) = delete;
  Editor& operator=(const Editor&) = delete;

  /// Ends the thread, after what it is doing. Nothing it was asked for happens any more.
  void stop();

  /// Takes MakeEdit, Undo, Redo, Reset, and Save of a scene.
  /// @return  false if too much waits already
  bool post(int client, int64_t number, const Request& request);
  void forget(int client) { inbox_.forget(client); }

  /// A state of the scene and, by page, the last message that is in it.
  struct Made {
    StatePtr state;
    std::map<int, int64_t> handled;
  };
  Made made() const;

  /// What a page must be told of the scene as it is now.
  std::string scene_text() const;

  /// Edits, undos and resets made.
  int64_t steps() const { return steps_; }

 private:
  void run();
  void work(const Inbox::Batch& batch);
  void make(std::span<const Pending> edits);
  void turn_back(const Pending& pending);
  void save(int client);
  void reset();
  void announce(const EditReport& report);
  UndoSteps undo_steps() const;

  Session* session_;
  const SceneDescription* scene_;
  Pages* pages_;
  std::function<void()> changed_;
  std::vector<PageEdit> loaded_;
  std::pair<int, int64_t> last_gesture_;  ///< page and gesture of the last step; 0 for none
  Inbox inbox_;
  mutable std::mutex mutex_;
  Made made_;
  std::atomic<int64_t> steps_ = 0;
  std::atomic<bool> stopping_ = false;
  std::thread thread_;
};

}  // namespace lte::infer::view
