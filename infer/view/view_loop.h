// The one rendering that all pages look at: a thread that draws the newest state, better and better
// while nothing changes.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "infer/view/display_layers.h"
#include "infer/view/editor.h"
#include "infer/view/inbox.h"
#include "infer/view/pages.h"
#include "infer/view/progressive.h"
#include "infer/view/replies.h"
#include "infer/view/scene_description.h"
#include "lte/base/timer.h"

namespace lte::infer::view {

/// What is shown, and how.
struct ViewState {
  scene::Camera camera;
  Shown shown = Shown::Full;
  float ev = 0;
  ToneCurve curve = ToneCurve::Linear;
  PictureSize size;
};

class ViewLoop {
 public:
  using AtRest = std::function<void(const scene::Camera& camera)>;

  /// @param newest   the state to show; must not block for long
  /// @param first    what is shown before a page asks for anything else
  /// @param at_rest  called, by the loop's thread, with each camera at rest; may be null
  ViewLoop(std::function<Editor::Made()> newest, Pages* pages, const ViewState& first,
           AtRest at_rest = {});
  ~ViewLoop();
  ViewLoop(const ViewLoop&) = delete;
  ViewLoop& operator=(const ViewLoop&) = delete;

  /// Ends the thread, after what it is doing. Nothing it was asked for happens any more.
  void stop();

  /// Takes MoveCamera, ChangeView, PickAt, and Save of a picture or camera.
  /// @return  false if too much waits already
  bool post(int client, int64_t number, const Request& request);
  void forget(int client) { inbox_.forget(client); }
  /// There is a new state, or a new page.
  void wake() { inbox_.wake(); }

  struct Counts {
    int64_t passes = 0;    ///< rendered
    int64_t pictures = 0;  ///< shown
    int64_t cameras = 0;   ///< that pictures began with
  };
  Counts counts() const { return {passes_, pictures_, cameras_}; }

 private:
  void run();
  void turn();
  void take(Editor::Made newest);
  void handle(const Pending& pending);
  void change(const ChangeView& change);
  void save(int client, SaveFormat format);
  void finish_whole();
  void render();
  void publish();
  float exposure();
  DisplayPicture display();
  bool outdated() const;
  void tell_of_rest();

  std::function<Editor::Made()> newest_;
  AtRest at_rest_;
  Pages* pages_;
  ViewState view_;
  Inbox inbox_;
  Progressive progressive_;
  Editor::Made made_;  ///< that is shown
  std::map<int, Handled> handled_;
  /// Exposures before `ev`, of radiance and of irradiance; nothing before the first picture.
  std::optional<float> radiance_exposure_, irradiance_exposure_;
  bool restart_ = true, redisplay_ = false, failed_ = false;
  bool relit_ = false;  ///< since the last draft
  bool moved_ = true;   ///< the camera, since it last rested
  Timer moving_;        ///< since the camera last moved
  int64_t picture_ = 0;
  std::atomic<int64_t> passes_ = 0, pictures_ = 0, cameras_ = 0;
  std::atomic<bool> stopping_ = false;
  std::thread thread_;
};

}  // namespace lte::infer::view
