#include "infer/view/view_loop.h"

#include <chrono>
#include <cmath>
#include <filesystem>
#include <utility>

#include "infer/view/display_layers.h"
#include "infer/view/picture_encoder.h"
#include "infer/view/session_scene.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/base/scratch_folder.h"
#include "lte/base/text.h"
#include "lte/base/timer.h"
#include "lte/image/exr.h"
#include "lte/image/png.h"
#include "lte/image/tonemap.h"
#include "lte/scene/load_camera.h"

namespace lte::infer::view {
namespace {

/// Behind a draft: who moves on within this time sees the next draft at once, and does not wait for
/// a stage of a whole picture that nobody will see. Who dims a lamp waits for none: what is
/// rendered stays good.
constexpr std::chrono::milliseconds kRest(100);
constexpr double kRestSeconds = std::chrono::duration<double>(kRest).count();

using SharedFrame = std::shared_ptr<const std::string>;

SharedFrame shared_file(const std::string& name, const std::string& media,
                        const std::string& bytes) {
  return std::make_shared<const std::string>(file_frame(name, media, bytes));
}

std::string png_of(const DisplayPicture& picture) {
  const std::vector<unsigned char> bytes = image::encode_png(picture);
  return {bytes.begin(), bytes.end()};
}

std::string exr_of(const image::Image& picture, const scene::Camera& camera) {
  const ScratchFolder folder;
  const std::filesystem::path file = folder.path() / "picture.exr";
  image::write_exr(file, {{"", &picture}}, {{scene::kCameraAttribute, scene::camera_json(camera)}});
  return read_file(file);
}

}  // namespace

ViewLoop::ViewLoop(std::function<Editor::Made()> newest, Pages* pages, const ViewState& first,
                   AtRest at_rest)
    : newest_(std::move(newest)), at_rest_(std::move(at_rest)), pages_(pages), view_(first) {
  const Editor::Made made = newest_();
  if (!made.scene->outputs.empty()) view_.shown = made.scene->outputs.front();
  thread_ = std::thread([this] { run(); });
}

ViewLoop::~ViewLoop() { stop(); }

void ViewLoop::stop() {
  stopping_ = true;
  inbox_.wake();
  if (thread_.joinable()) thread_.join();
}

bool ViewLoop::post(int client, int64_t number, const Request& request) {
  return inbox_.post(client, number, request);
}

void ViewLoop::run() {
  while (!stopping_) {
    try {
      turn();
    } catch (const std::exception& error) {  // memory, most likely: the next change may mend it
      failed_ = true;
      log_warning("rendering failed: ", first_line(error.what()));
      pages_->tell_all(error_reply(concat("rendering failed: ", first_line(error.what()))));
    }
  }
}

/// Whether what is being rendered is no longer what there is to show.
bool ViewLoop::outdated() const { return stopping_ || inbox_.waiting(); }

void ViewLoop::turn() {
  // Passes behind a draft would only take time from the light that is on its way.
  const bool waits = progressive_.done() || (!made_.settled && progressive_.pass() > 0);
  const bool rests = failed_ || pages_->count() == 0 || (!restart_ && waits && !moved_);
  const bool moves = !restart_ && ((!relit_ && progressive_.pass() == 1) || (waits && moved_));
  const Inbox::Batch batch = inbox_.take(rests ? Inbox::kAnyTime : moves ? kRest : Inbox::kNoWait);
  if (stopping_) return;
  failed_ = false;
  take(newest_());
  for (const Pending& pending : batch.requests) handle(pending);
  handled_.clear();
  for (const auto& [client, number] : batch.last_number) handled_[client].view = number;
  for (const auto& [client, number] : made_.handled) handled_[client].edits = number;
  if (pages_->count() == 0) return;
  render();
}

void ViewLoop::take(Editor::Made newest) {
  const bool other = !made_.state || newest.state->version() != made_.state->version();
  made_ = std::move(newest);
  if (!other) return;
  if (!restart_ && progressive_.relight(made_.state)) {
    redisplay_ = relit_ = true;
  } else {
    restart_ = true;
  }
}

void ViewLoop::handle(const Pending& pending) {
  if (const auto* move = std::get_if<MoveCamera>(&pending.request)) {
    const bool mirrored = view_.camera.mirrored;
    view_.camera = move->camera;
    view_.camera.mirrored = mirrored;
    restart_ = moved_ = true;
    moving_.restart();
    ++cameras_;
  } else if (const auto* view = std::get_if<ChangeView>(&pending.request)) {
    change(*view);
  } else if (const auto* at = std::get_if<PickAt>(&pending.request)) {
    const float aspect =
        static_cast<float>(view_.size.width) / static_cast<float>(view_.size.height);
    pages_->tell(pending.client, picked_reply(pick(*made_.state, *made_.scene, view_.camera, aspect,
                                                   at->x, at->y)));
  } else if (const auto* what = std::get_if<Save>(&pending.request)) {
    try {
      save(pending.client, what->format);
    } catch (const std::exception& error) {
      pages_->tell(pending.client, error_reply(first_line(error.what())));
    }
  }
}

void ViewLoop::change(const ChangeView& change) {
  if (change.shown && *change.shown != view_.shown) {
    view_.shown = *change.shown;
    restart_ = true;
  }
  if (change.size && *change.size != view_.size) {
    view_.size = *change.size;
    restart_ = true;
  }
  if (change.ev) view_.ev = *change.ev;
  if (change.curve) view_.curve = *change.curve;
  if (change.meter) radiance_exposure_ = irradiance_exposure_ = std::nullopt;
  redisplay_ = true;
}

void ViewLoop::render() {
  if (std::exchange(restart_, false)) {
    relit_ = false;
    progressive_.restart(made_.state, view_.camera, view_.shown, view_.size);
  } else if (redisplay_ && progressive_.pass() > 0) {
    return publish();
  }
  tell_of_rest();
  if (progressive_.done() || (!made_.settled && progressive_.pass() > 0)) return;
  const int64_t before = progressive_.rendered();
  const bool shows = progressive_.step([this] { return outdated(); });
  passes_ += progressive_.rendered() - before;
  if (shows) publish();
}

/// A camera rests when its draft has been seen and none has followed for a while: what is found out
/// then takes no time from who drags, and comes early in what is refined.
void ViewLoop::tell_of_rest() {
  if (!moved_ || progressive_.pass() == 0 || moving_.seconds() < kRestSeconds) return;
  moved_ = false;
  if (at_rest_) at_rest_(view_.camera);
}

/// The factor before the curve. It is metered once, so that a dimmed light looks dimmer.
float ViewLoop::exposure() {
  const bool is_irradiance = view_.shown == Shown::Irradiance;
  std::optional<float>& base = is_irradiance ? irradiance_exposure_ : radiance_exposure_;
  if (!base)
    base = image::auto_exposure(progressive_.picture(), 0.95f, 0.8f, progressive_.surfaces());
  return *base * std::exp2(view_.ev);
}

DisplayPicture ViewLoop::display() {
  const image::Image& picture = progressive_.picture();
  switch (view_.shown) {
    case Shown::Albedo:
      return display_albedo(picture);
    case Shown::Normal:
      return display_normal(picture);
    case Shown::Difference:
      if (progressive_.reference().width == picture.width)
        return display_difference(picture, progressive_.reference(), exposure());
      [[fallthrough]];
    default:
      return image::display(picture, exposure(), view_.curve);
  }
}

void ViewLoop::publish() {
  redisplay_ = false;
  const Timer timer;
  const DisplayPicture shown = display();
  const bool draft = progressive_.pass() < 2;
  const std::string jpeg = encode_jpeg(shown, draft ? JpegQuality::Moving : JpegQuality::Still);
  const StageSeconds& seconds = progressive_.seconds();
  PictureHeader header;
  header.picture = ++picture_;
  header.camera = view_.camera;
  header.shown = view_.shown;
  header.ev = view_.ev;
  header.curve = view_.curve;
  header.size = view_.size;
  header.width = shown.width;
  header.height = shown.height;
  header.pass = progressive_.pass();
  header.passes = progressive_.passes();
  header.done = progressive_.done() && made_.settled;
  header.light = made_.state->accuracy();
  const std::optional<Method> by = made_.state->answered_by();
  header.answered_by = by ? enum_name(*by) : "path";
  header.check = progressive_.check();
  header.paths = progressive_.paths();
  for (const Stage& stage : kStages) {
    if (seconds.*stage.seconds > 0) header.milliseconds[stage.name] = 1e3 * seconds.*stage.seconds;
  }
  header.milliseconds["jpeg"] = 1e3 * timer.seconds();
  header.elapsed_ms = 1e3 * progressive_.elapsed();
  header.path_ms = 1e3 * progressive_.path_seconds();
  header.handled = handled_;
  ++pictures_;
  pages_->show(picture_, std::make_shared<const std::string>(picture_frame(header, jpeg)));
}

/// A draft is no picture to keep: makes the whole one of now, whatever waits.
void ViewLoop::finish_whole() {
  if (std::exchange(restart_, false)) {
    relit_ = false;
    redisplay_ = true;
    progressive_.restart(made_.state, view_.camera, view_.shown, view_.size);
  }
  while (progressive_.pass() < 2 && !stopping_) {
    const int64_t before = progressive_.rendered();
    progressive_.step([this] { return stopping_.load(); });
    passes_ += progressive_.rendered() - before;
    redisplay_ = true;
  }
  LTE_CHECK(progressive_.pass() >= 2, "there is no picture: the server ends");
}

void ViewLoop::save(int client, SaveFormat format) {
  const std::string& name = made_.scene->name;
  if (format == SaveFormat::Camera)
    return pages_->give(client, shared_file(name + "_camera.json", "application/json",
                                            scene::camera_json(view_.camera) + '\n'));
  finish_whole();
  if (format == SaveFormat::Png)
    return pages_->give(client, shared_file(name + ".png", "image/png", png_of(display())));
  pages_->give(client, shared_file(name + ".exr", "image/x-exr",
                                   exr_of(progressive_.picture(), view_.camera)));
}

}  // namespace lte::infer::view
