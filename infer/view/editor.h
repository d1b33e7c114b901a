// The edits of all pages, made one after another in a thread of their own: the camera moves on
// while a scene is encoded anew.
//
// An edit is seen at once, with the indirect light of before (Accuracy::Kept). Then its light is
// found for half the points, and once the pages rest all of it. What rests longer gets its
// luminaires encoded apart, so that they are dimmed without encoding.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "infer/session/session.h"
#include "infer/view/inbox.h"
#include "infer/view/pages.h"
#include "infer/view/scene_description.h"
#include "lte/base/timer.h"

namespace lte::infer::view {

class Editor {
 public:
  /// Luminaires that are encoded apart before anybody dims them, at most: each layer costs an
  /// encoding after every move, and answers in every picture, so that with four a camera's edits
  /// took three times as long.
  static constexpr int kMaxApart = 2;

  /// Both must outlive the editor.
  /// @param changed  called by the editor's thread when there is a new state
  Editor(Session* session, Pages* pages, std::function<void()> changed);
  ~Editor();
  Editor(const Editor&) = delete;
  Editor& operator=(const Editor&) = delete;

  /// Begins to work. What is asked for before waits.
  void start();
  /// Ends the thread, after what it is doing. Nothing it was asked for happens any more.
  void stop();

  /// Takes MakeEdit, CopyObject, RemoveObject, AddLamp, RemoveLamp, Undo, Redo, Reset, and Save of
  /// a scene.
  /// @return  false if too much waits already
  bool post(int client, int64_t number, const Request& request);
  void forget(int client) { inbox_.forget(client); }

  /// The camera has come to rest here. Once no request waits the light is left out that does not
  /// reach what it sees, or brought in again; the last camera counts. May be called by any thread.
  void look_from(const scene::Camera& camera);

  /// A state of the scene and, by page, the last message that is in it.
  struct Made {
    StatePtr state;
    std::shared_ptr<const SceneDescription> scene;
    std::map<int, int64_t> handled = {};
    bool settled = true;  ///< no more accurate light is on its way
  };
  Made made() const;

  /// The scene as it is now, for a page.
  std::string scene_text() const;

  /// Edits, undos and resets made.
  int64_t steps() const { return steps_; }

 private:
  /// What is to be done when no request waits.
  enum class Next { Nothing, DraftLight, FullLight, Separation };

  void run();
  void work(const Inbox::Batch& batch);
  void answer(std::span<const Pending> step);
  void make(std::span<const Pending> edits);
  void restructure(const Pending& pending);
  void turn_back(const Pending& pending);
  void save(int client);
  void improve();
  bool camera_waits() const;
  std::optional<scene::Camera> take_camera();
  std::optional<EditReport> look(const scene::Camera& camera, const Session::Stop& stop);
  void announce(const EditReport& report);
  void describe();
  void publish(const std::map<int, int64_t>* handled);
  Next next_after(const SessionState& state) const;
  bool is_light_due() const;
  UndoSteps undo_steps() const;

  Session* session_;
  Pages* pages_;
  std::function<void()> changed_;
  std::vector<ObjectDescription> objects_;  ///< those that undo could bring back included
  std::pair<int, int64_t> last_gesture_;    ///< page and gesture of the last step; 0 for none
  Next next_ = Next::Nothing;
  Timer kept_;  ///< since the light was last more than Accuracy::Kept
  Inbox inbox_;
  mutable std::mutex mutex_;  ///< guards what follows
  Made made_;
  std::optional<scene::Camera> camera_;  ///< to look from
  std::atomic<int64_t> steps_ = 0;
  std::atomic<bool> stopping_ = false, idle_ = false;
  std::thread thread_;
};

}  // namespace lte::infer::view
