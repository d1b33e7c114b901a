#include "infer/view/progressive.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "infer/render/quality.h"
#include "lte/base/timer.h"

namespace lte::infer::view {
namespace {

constexpr int kMostPathsAtOnce = 8;
constexpr int kDraftSteps = 8;     // a draft has at least an eighth of the sides
constexpr int kMeasuredShare = 4;  // of the sides, when a path a pixel is measured

/// A pass that nobody waits for any more.
struct Interrupted {};

std::function<void(int64_t)> throwing(const std::function<bool()>& interrupted) {
  if (!interrupted) return {};
  return [&interrupted](int64_t) {
    if (interrupted()) throw Interrupted();
  };
}

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
    draft_.reset();
  }
  if (light_) {
    light_->clear();
    draft_->clear();
  }
  state_ = std::move(state);
  camera_ = camera;
  shown_ = shown;
  size_ = size;
  averaged_ = 0;
  residual_.clear();
  check_.reset();
  reference_sum_ = {};
  reference_ = {};
  pass_ = 0;
  elapsed_ = 0;
}

int Progressive::passes() const {
  const int neural =
      (shown_ == Shown::Reference ? 0 : kMeanPasses) + (corrects() ? Residual::kSteps + 1 : 0);
  return 2 + neural + (traces() ? kReferencePaths / kMostPathsAtOnce : 0);
}

bool Progressive::done() const {
  const bool summed = shown_ == Shown::Reference || averaged_ >= kMeanPasses;
  const bool traced = !traces() || reference_sum_.weight >= kReferencePaths;
  return pass_ >= 2 && summed && traced && (!corrects() || (check_ && residual_.done()));
}

double Progressive::paths() const { return traces() ? reference_sum_.weight : residual_.paths(); }

/// Whether paths have something to say of the network's light. A difference shows the network as it
/// is.
bool Progressive::corrects() const {
  const bool indirect =
      shown_ == Shown::Full || shown_ == Shown::Indirect || shown_ == Shown::Irradiance;
  return indirect && state_ != nullptr && state_->answered_by() && state_->has_light();
}

bool Progressive::gathers() const {
  return state_->answered_by() && state_->answered_by() != PictureLight::Decoded;
}

int Progressive::least_mean() const { return gathers() ? kLeastGathered : kLeastMean; }

PictureSize Progressive::draft_size() const {
  const double share = std::sqrt(kDraftSeconds / (draft_pixel_seconds_ * pixels()));
  const int step = std::clamp(static_cast<int>(std::ceil(1 / share)), 1, kDraftSteps);
  return {std::max(1, size_.width / step), std::max(1, size_.height / step)};
}

/// @param few  shadow rays: of the first whole pictures, which are waited for
RenderSettings Progressive::settings(const PictureSize& size, bool few) const {
  const QualitySettings quality = quality_settings(Quality::Draft);
  RenderSettings out;
  out.output = output_of(shown_);
  out.width = size.width;
  out.height = size.height;
  out.direct_samples = few ? quality.direct_samples : 2 * quality.direct_samples;
  if (gathers()) {
    // A filter cannot be interrupted: that of direct light, which sees all pixels, runs once, in
    // the first whole picture. Gathered light's sees a quarter of them.
    const bool draft = pass_ == 0, first = pass_ <= 1;
    out.gather = draft ? quality.gather : quality_settings(Quality::Preview).gather;
    out.gather.quality = image::OidnQuality::Fast;
    out.gather.denoise = true;
    if (draft) out.direct_samples = quality.gather_direct_samples;
    out.denoise = first ? Denoise::Auto : Denoise::Off;
  } else {
    // Opening a filter and running it takes longer than a draft may.
    out.denoise = Denoise::Off;
  }
  out.spp = kPaths;
  out.antialias = 0;
  const bool rests = averaged_ >= least_mean();
  out.sparse = rests ? quality_settings(Quality::Preview).answers : quality.answers;
  out.layers = false;
  out.seed = static_cast<uint64_t>(pass_);
  return out;
}

Frame Progressive::render(const scene::Camera& camera, RenderSettings settings,
                          const std::function<bool()>& interrupted) {
  settings.done = throwing(interrupted);
  Frame frame = state_->render(camera, settings, &seconds_);
  if (interrupted && interrupted()) throw Interrupted();
  return frame;
}

void Progressive::prepare_sums() {
  if (light_) return;
  light_.emplace(state_, output_of(shown_), static_cast<int64_t>(pixels()));
  draft_ = light_;  // of the same layers
}

void Progressive::add_light(const scene::Camera& camera, RenderSettings settings, bool anew,
                            const std::function<bool()>& interrupted) {
  prepare_sums();
  settings.done = throwing(interrupted);
  light_->add(camera, std::move(settings), anew, &seconds_);
}

/// The sum that the picture is made of; null if there is none.
const DimmablePicture* Progressive::sum_shown() const {
  for (const std::optional<DimmablePicture>* sum : {&light_, &draft_}) {
    if (*sum && (*sum)->pictures() > 0) return &**sum;
  }
  return nullptr;
}

void Progressive::show_light() {
  const DimmablePicture& sum = *sum_shown();
  image::Image picture = sum.color(*state_);
  residual_.add_to(&picture);
  show(std::move(picture), sum.depth());
}

bool Progressive::relight(const StatePtr& state) {
  const DimmablePicture* sum = sum_shown();
  if (traces() || sum == nullptr || !sum->fits(*state)) return false;
  state_ = state;
  residual_.clear();  // it was of other light
  check_.reset();
  picture_ = sum->color(*state_);
  return true;
}

void Progressive::show(image::Image picture, const image::Image& depth) {
  picture_ = std::move(picture);
  surfaces_.resize(depth.pixels.size());
  std::transform(depth.pixels.begin(), depth.pixels.end(), surfaces_.begin(),
                 [](float d) { return d > 0 ? uint8_t{1} : uint8_t{0}; });
}

void Progressive::draft() {
  const PictureSize size = draft_size();
  RenderSettings what = settings(size, /*few=*/false);
  Timer timer;
  if (shown_ == Shown::Reference) {
    what.mode = Mode::Reference;
    what.spp = 1;
    Frame frame = render(camera_, what, nullptr);
    show(std::move(frame.color), frame.depth);
  } else {
    prepare_sums();
    timer.restart();  // the next draft need not prepare them
    const int layers = draft_->layers();
    if (layers > 1) {
      what = settings(size, /*few=*/true);
      // Each has its share of the light: an error in one is so much less in the sum.
      if (what.sparse) what.sparse->tolerance *= static_cast<float>(layers);
    }
    const bool whole = size == size_;
    (whole ? light_ : draft_)->add(camera_, what, /*anew=*/true, &seconds_);
    if (whole) ++pass_;
    show_light();
  }
  draft_pixel_seconds_ = timer.seconds() / (double(size.width) * size.height);
}

void Progressive::whole(const std::function<bool()>& interrupted) {
  if (shown_ == Shown::Reference) return trace(interrupted);
  add_light(camera_, settings(size_, /*few=*/true), /*anew=*/true, interrupted);
  show_light();
}

bool Progressive::mean(const std::function<bool()>& interrupted) {
  const int number = averaged_ + 1;
  const scene::Camera camera =
      jittered(camera_, size_, halton(number, 2) - 0.5f, halton(number, 3) - 0.5f);
  const bool few = !gathers() && averaged_ < kLeastMean;  // they are waited for
  add_light(camera, settings(size_, few), /*anew=*/averaged_ == 0, interrupted);
  if (++averaged_ < least_mean()) return false;
  show_light();
  return true;
}

bool Progressive::correct(const std::function<bool()>& interrupted) {
  RenderSettings what = settings(size_, /*few=*/false);
  what.done = throwing(interrupted);
  if (!residual_.step(*state_, camera_, std::move(what), &seconds_)) return false;
  show_light();
  return true;
}

/// A few thousand paths hold what answers to account.
bool Progressive::check_answers(const std::function<bool()>& interrupted) {
  RenderSettings what = settings(size_, /*few=*/false);
  what.done = throwing(interrupted);
  residual_.answer(*state_, camera_, what);
  if (interrupted && interrupted()) throw Interrupted();
  CheckOptions options;
  options.seconds = kCheckSeconds;
  check_ = check_light(state_->bvh(), state_->lights(), residual_.answered(), options);
  return true;
}

/// Adds paths to the reference: one a pixel at first, then as many as there are, up to a limit.
void Progressive::trace(const std::function<bool()>& interrupted) {
  RenderSettings what;
  what.mode = Mode::Reference;
  what.width = size_.width;
  what.height = size_.height;
  what.spp = std::clamp(static_cast<int>(reference_sum_.weight), 1, kMostPathsAtOnce);
  what.seed = static_cast<uint64_t>(pass_);
  what.layers = false;
  const Timer timer;
  Frame frame = render(camera_, what, interrupted);
  path_pixel_seconds_ = timer.seconds() / (pixels() * what.spp);
  reference_sum_.add(frame.color, what.spp);
  if (shown_ == Shown::Reference) {
    show(reference_sum_.mean(), frame.depth);
  } else {
    reference_ = reference_sum_.mean();
  }
}

void Progressive::measure_path(const std::function<bool()>& interrupted) {
  RenderSettings what;
  what.mode = Mode::Reference;
  what.width = std::max(1, size_.width / kMeasuredShare);
  what.height = std::max(1, size_.height / kMeasuredShare);
  what.spp = 1;
  what.layers = false;
  const Timer timer;
  const StageSeconds seconds = seconds_;
  render(camera_, what, interrupted);
  seconds_ = seconds;
  path_pixel_seconds_ = timer.seconds() / (double(what.width) * what.height);
}

bool Progressive::step(const std::function<bool()>& interrupted) {
  const Timer timer;
  bool shows = true;
  try {
    seconds_ = {};
    if (pass_ == 0) {
      draft();
    } else if (pass_ == 1) {
      whole(interrupted);
    } else if (shown_ != Shown::Reference && averaged_ < kMeanPasses) {
      shows = mean(interrupted);
    } else if (corrects() && !check_) {
      shows = check_answers(interrupted);
    } else if (corrects()) {
      shows = correct(interrupted);
    } else {
      trace(interrupted);
    }
    ++pass_;
    ++rendered_;
    elapsed_ += timer.seconds();
    if (path_pixel_seconds_ == 0 && done() && state_->has_light()) measure_path(interrupted);
  } catch (const Interrupted&) {
    elapsed_ += timer.seconds();
    return false;
  }
  return shows;
}

}  // namespace lte::infer::view
