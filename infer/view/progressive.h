// A picture that gets better pass by pass: a first pass within a fraction of a frame's time, a
// whole picture by few rays, then the mean of many such with other rays and other places in the
// pixels. Each is a sum by luminaire, so that dimming one begins nothing anew.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "infer/check/light_check.h"
#include "infer/renderer/renderer.h"
#include "infer/session/dimmable_picture.h"
#include "infer/session/session.h"
#include "infer/view/view_state.h"
#include "lte/image/image.h"

namespace lte::infer::view {

/// What a pass takes at least before it may be interrupted is one stage of Renderer.
class Progressive {
 public:
  /// Seconds that a first pass may take; its size is chosen by what the last ones took.
  static constexpr double kFirstPassSeconds = 0.06;
  /// Passes whose mean the picture is in the end. The mean is shown from kMinMean of them on.
  static constexpr int kMeanPasses = 24, kMinMean = 2;
  /// Paths a pixel of a reference that is done.
  static constexpr int kReferencePaths = 1024;
  /// Seconds that the check may take, about.
  static constexpr double kCheckSeconds = 0.5;

  /// Begins anew.
  void restart(StatePtr state, const scene::Camera& camera, Shown shown, const PictureSize& size);

  /// Takes a state that differs by gains and colors alone: the picture is as it would be if all
  /// its passes had been rendered with it. A pass that was interrupted goes on.
  /// @return  false, and nothing has changed, if it must begin anew
  bool relight(const StatePtr& state);

  bool done() const;
  /// Renders the next pass.
  /// @param interrupted  asked now and then by any thread; a pass that it ends has not happened. A
  ///                     first pass is never interrupted: one that moves on must see something.
  /// @return  whether there is another picture to show
  bool step(const std::function<bool()>& interrupted);

  /// What there is to show, linear.
  const image::Image& picture() const { return picture_; }
  /// What paths say of the indirect light that is shown, once it has rested; nothing before.
  const std::optional<LightCheck>& check() const { return check_; }
  /// Of Shown::Difference: what `picture` is held against, empty while there is none.
  const image::Image& reference() const { return reference_; }
  /// 1 where a surface is seen, a byte a pixel of the picture.
  const std::vector<uint8_t>& surfaces() const { return surfaces_; }

  int pass() const { return pass_; }  ///< of those done; 1 after the first pass
  int passes() const;
  double paths() const { return reference_sum_.weight; }    ///< a pixel, of all that were traced
  const StageSeconds& seconds() const { return seconds_; }  ///< of the last pass
  double elapsed() const { return elapsed_; }               ///< seconds of all since restart()
  /// Seconds of a path a pixel for this size, measured when one was traced; 0 before.
  double path_seconds() const { return path_pixel_seconds_ * pixels(); }
  int64_t rendered() const { return rendered_; }  ///< passes since the beginning

 private:
  /// Weighted sum of references.
  struct Sum {
    image::Image light;
    double weight = 0;
    void add(const image::Image& picture, double by);
    image::Image mean() const;
  };
  double pixels() const { return double(size_.width) * size_.height; }
  PictureSize first_pass_size() const;
  bool traces() const { return shown_ == Shown::Reference || shown_ == Shown::Difference; }
  bool checks() const;
  RenderSettings settings(const PictureSize& size) const;
  RenderSettings traced(const PictureSize& size, int paths) const;
  Frame render(const scene::Camera& camera, RenderSettings settings,
               const std::function<bool()>& interrupted);
  void prepare_sums();
  void add_light(const scene::Camera& camera, RenderSettings settings, bool anew,
                 const std::function<bool()>& interrupted);
  void first_pass();
  void whole(const std::function<bool()>& interrupted);
  bool mean(const std::function<bool()>& interrupted);
  bool check_answers(const std::function<bool()>& interrupted);
  void trace(const std::function<bool()>& interrupted);
  void measure_path(const std::function<bool()>& interrupted);
  void show(image::Image picture, const image::Image& depth);
  void show_light();
  const DimmablePicture* sum_shown() const;

  StatePtr state_;
  scene::Camera camera_;
  Shown shown_ = Shown::Full;
  PictureSize size_;
  image::Image picture_, reference_;
  std::vector<uint8_t> surfaces_;
  /// The whole picture, or the mean of `averaged_` ones, and the first pass before it. Either none,
  /// or both for this state and, perhaps, still without a picture.
  std::optional<DimmablePicture> light_, first_pass_;
  int averaged_ = 0;
  std::optional<LightCheck> check_;
  Sum reference_sum_;
  int pass_ = 0;
  StageSeconds seconds_;
  double elapsed_ = 0;
  double first_pass_pixel_seconds_ = 1e-6;  ///< a guess until the first one
  double path_pixel_seconds_ = 0;
  int64_t rendered_ = 0;
};

/// The camera turned by a fraction of a pixel, so that pixel centres fall elsewhere.
scene::Camera jittered(const scene::Camera& camera, const PictureSize& size, float x, float y);

}  // namespace lte::infer::view
