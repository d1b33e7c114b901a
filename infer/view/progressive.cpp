#include "infer/view/progressive.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "infer/check/checked_pixels.h"
#include "infer/renderer/quality.h"
#include "lte/base/random.h"
#include "lte/base/timer.h"

namespace lte::infer::view {
namespace {

constexpr int kMaxPathsAtOnce = 8;
constexpr int kEdgeRays = 16;  // of the first whole picture
/// Rays and light samples a pixel of the passes at rest, which nobody waits for.
constexpr int kRestingRays = 8, kRestingLightSamples = 64;
constexpr image::OidnQuality kAtRest = image::OidnQuality::Balanced;
constexpr int kFirstPassSteps = 8;  // a first pass has at least an eighth of the sides
constexpr int kMeasuredShare = 4;   // of the sides, when a path a pixel is measured
/// What is checked is a picture of its own, of so many passes.
constexpr int kCheckedPasses = 4;
constexpr uint64_t kCheckedPlaces = 51;  // independent of all that pictures draw

/// The element `index` of Halton's sequence in this base, in [0, 1).
float halton(int index, int base) {
  float value = 0, digit = 1;
  for (; index > 0; index /= base) {
    digit /= static_cast<float>(base);
    value += digit * static_cast<float>(index % base);
  }
  return value;
}

Output output_of(Shown shown) {
  switch (shown) {
    case Shown::Indirect:
      return Output::Gi;
    case Shown::Direct:
      return Output::Direct;
    case Shown::Irradiance:
      return Output::Irradiance;
    case Shown::Albedo:
      return Output::Albedo;
    case Shown::Normal:
      return Output::Normal;
    default:
      return Output::Full;
  }
}

}  // namespace

scene::Camera jittered(const scene::Camera& camera, const PictureSize& size, float x, float y) {
  const Vec3 view = camera.target - camera.origin;
  const Vec3 right = normalize(cross(view, camera.up)), above = normalize(cross(right, view));
  const float pixel =
      2 * length(view) * std::tan(camera.vfov * kPi / 360) / static_cast<float>(size.height);
  scene::Camera out = camera;
  out.target = camera.target + right * (x * pixel) + above * (y * pixel);
  return out;
}

void Progressive::Sum::add(const image::Image& picture, double by) {
  if (light.width == 0) light = image::Image(picture.width, picture.height, picture.channels);
  const auto factor = static_cast<float>(by);
  for (size_t i = 0; i < light.pixels.size(); ++i) light.pixels[i] += factor * picture.pixels[i];
  weight += by;
}

image::Image Progressive::Sum::mean() const {
  image::Image out = light;
  const auto factor = static_cast<float>(1 / weight);
  for (float& value : out.pixels) value *= factor;
  return out;
}

void Progressive::restart(StatePtr state, const scene::Camera& camera, Shown shown,
                          const PictureSize& size) {
  const bool same = size == size_ && output_of(shown) == output_of(shown_);
  if (!same || (light_ && !light_->fits(*state))) {
    light_.reset();
    first_pass_.reset();
  }
  if (light_) {
    light_->clear();
    first_pass_->clear();
  }
  state_ = std::move(state);
  camera_ = camera;
  shown_ = shown;
  size_ = size;
  averaged_ = 0;
  check_.reset();
  reference_sum_ = {};
  reference_ = {};
  pass_ = 0;
  elapsed_ = 0;
}

int Progressive::passes() const {
  const int gathered = (shown_ == Shown::Reference ? 0 : kMeanPasses) + (checks() ? 1 : 0);
  return 2 + gathered + (traces() ? kReferencePaths / kMaxPathsAtOnce : 0);
}

bool Progressive::done() const {
  const bool summed = shown_ == Shown::Reference || averaged_ >= kMeanPasses;
  const bool traced = !traces() || reference_sum_.weight >= kReferencePaths;
  return pass_ >= 2 && summed && traced && (!checks() || check_);
}

/// Whether paths have something to say of the light that is shown. A difference shows it as it is.
bool Progressive::checks() const {
  const bool indirect =
      shown_ == Shown::Full || shown_ == Shown::Indirect || shown_ == Shown::Irradiance;
  return indirect && state_ != nullptr && state_->answered_by() && state_->has_light();
}

PictureSize Progressive::first_pass_size() const {
  const double share = std::sqrt(kFirstPassSeconds / (first_pass_pixel_seconds_ * pixels()));
  const int step = std::clamp(static_cast<int>(std::ceil(1 / share)), 1, kFirstPassSteps);
  return {std::max(1, size_.width / step), std::max(1, size_.height / step)};
}

RenderSettings Progressive::settings(const PictureSize& size) const {
  RenderSettings out = with_quality(Quality::Draft, {});
  out.output = output_of(shown_);
  out.width = size.width;
  out.height = size.height;
  out.denoise = pass_ <= 1;  // the mean of later passes is denoised as a whole
  out.edge_rays = pass_ == 1 ? kEdgeRays : 0;
  if (pass_ > 1) {
    out.gather_rays = kRestingRays;
    out.light_samples = kRestingLightSamples;
  }
  out.correct = out.layers = false;
  out.seed = static_cast<uint64_t>(pass_);
  return out;
}

Frame Progressive::render(const scene::Camera& camera, RenderSettings settings,
                          const std::function<bool()>& interrupted) {
  settings.stop = interrupted;
  return state_->render(camera, settings, &seconds_);
}

void Progressive::prepare_sums() {
  if (light_) return;
  light_.emplace(state_, output_of(shown_), static_cast<int64_t>(pixels()));
  first_pass_ = light_;  // of the same layers
}

void Progressive::add_light(const scene::Camera& camera, RenderSettings settings, bool anew,
                            const std::function<bool()>& interrupted) {
  prepare_sums();
  settings.stop = interrupted;
  light_->add(camera, std::move(settings), anew, &seconds_);
}

/// The sum that the picture is made of; null if there is none.
const DimmablePicture* Progressive::sum_shown() const {
  for (const std::optional<DimmablePicture>* sum : {&light_, &first_pass_}) {
    if (*sum && (*sum)->pictures() > 0) return &**sum;
  }
  return nullptr;
}

void Progressive::show_light() {
  const DimmablePicture& sum = *sum_shown();
  show(sum.color(*state_), sum.depth());
}

bool Progressive::relight(const StatePtr& state) {
  const DimmablePicture* sum = sum_shown();
  if (traces() || sum == nullptr || !sum->fits(*state)) return false;
  state_ = state;
  check_.reset();                                                 // it was of other light
  if (light_ && averaged_ >= kMinMean) light_->denoise(kAtRest);  // where a pass was ended
  picture_ = sum->color(*state_);
  return true;
}

void Progressive::show(image::Image picture, const image::Image& depth) {
  picture_ = std::move(picture);
  surfaces_.resize(depth.pixels.size());
  std::transform(depth.pixels.begin(), depth.pixels.end(), surfaces_.begin(),
                 [](float d) { return d > 0 ? uint8_t{1} : uint8_t{0}; });
}

void Progressive::first_pass() {
  const PictureSize size = first_pass_size();
  RenderSettings what = settings(size);
  Timer timer;
  if (shown_ == Shown::Reference) {
    Frame frame = render(camera_, traced(size, 1), nullptr);
    show(std::move(frame.color), frame.depth);
  } else {
    prepare_sums();
    timer.restart();  // the next first pass need not prepare them
    const bool whole = size == size_;
    (whole ? light_ : first_pass_)->add(camera_, what, /*anew=*/true, &seconds_);
    if (whole) ++pass_;
    show_light();
  }
  first_pass_pixel_seconds_ = timer.seconds() / (double(size.width) * size.height);
}

void Progressive::whole(const std::function<bool()>& interrupted) {
  if (shown_ == Shown::Reference) return trace(interrupted);
  add_light(camera_, settings(size_), /*anew=*/true, interrupted);
  show_light();
}

bool Progressive::mean(const std::function<bool()>& interrupted) {
  const int number = averaged_ + 1;
  const scene::Camera camera =
      jittered(camera_, size_, halton(number, 2) - 0.5f, halton(number, 3) - 0.5f);
  add_light(camera, settings(size_), /*anew=*/averaged_ == 0, interrupted);
  if (++averaged_ < kMinMean) return false;
  if (interrupted && interrupted()) return false;  // the filter cannot be
  light_->denoise(kAtRest);
  show_light();
  return true;
}

/// A few thousand paths hold what is shown to account.
bool Progressive::check_answers(const std::function<bool()>& interrupted) {
  RenderSettings what = settings(size_);
  what.output = Output::Irradiance;
  what.passes = kCheckedPasses;
  what.denoise = true;
  const Frame frame = render(camera_, what, interrupted);
  CheckOptions options;
  options.seconds = kCheckSeconds;
  check_ = check_light(state_->bvh(), state_->lights(),
                       checked_pixels(state_->bvh(), camera_, frame, kCheckedPlaces), options);
  return true;
}

RenderSettings Progressive::traced(const PictureSize& size, int paths) const {
  RenderSettings out = with_paths(paths, {});
  out.method = Method::Path;
  out.width = size.width;
  out.height = size.height;
  out.denoise = false;
  out.edge_rays = 0;
  out.seed = static_cast<uint64_t>(pass_);
  return out;
}

/// Adds paths to the reference: one a pixel at first, then as many as there are, up to a limit.
void Progressive::trace(const std::function<bool()>& interrupted) {
  const int paths = std::clamp(static_cast<int>(reference_sum_.weight), 1, kMaxPathsAtOnce);
  const Timer timer;
  Frame frame = render(camera_, traced(size_, paths), interrupted);
  path_pixel_seconds_ = timer.seconds() / (pixels() * paths);
  reference_sum_.add(frame.color, paths);
  if (shown_ == Shown::Reference) {
    show(reference_sum_.mean(), frame.depth);
  } else {
    reference_ = reference_sum_.mean();
  }
}

void Progressive::measure_path(const std::function<bool()>& interrupted) {
  const PictureSize size{std::max(1, size_.width / kMeasuredShare),
                         std::max(1, size_.height / kMeasuredShare)};
  const Timer timer;
  const StageSeconds seconds = seconds_;
  render(camera_, traced(size, 1), interrupted);
  seconds_ = seconds;
  path_pixel_seconds_ = timer.seconds() / (double(size.width) * size.height);
}

bool Progressive::step(const std::function<bool()>& interrupted) {
  const Timer timer;
  bool shows = true;
  try {
    seconds_ = {};
    if (pass_ == 0) {
      first_pass();
    } else if (pass_ == 1) {
      whole(interrupted);
    } else if (shown_ != Shown::Reference && averaged_ < kMeanPasses) {
      shows = mean(interrupted);
    } else if (checks()) {
      shows = check_answers(interrupted);
    } else {
      trace(interrupted);
    }
    ++pass_;
    ++rendered_;
    elapsed_ += timer.seconds();
    if (path_pixel_seconds_ == 0 && done() && state_->has_light()) measure_path(interrupted);
  } catch (const PictureStopped&) {
    elapsed_ += timer.seconds();
    return false;
  }
  return shows;
}

}  // namespace lte::infer::view
