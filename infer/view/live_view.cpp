#include "infer/view/live_view.h"

#include <utility>
#include <variant>

#include "infer/view/replies.h"
#include "infer/view/session_scene.h"

namespace lte::infer::view {
namespace {

/// Whether the thread that edits has to answer.
bool is_edit(const Request& request) {
  if (const auto* save = std::get_if<Save>(&request)) return save->format == SaveFormat::Glb;
  return is_any<MakeEdit, CopyObject, RemoveObject, AddLamp, RemoveLamp, Undo, Redo, Reset>(
      request);
}

}  // namespace

LiveView::LiveView(boost::asio::io_context* io)
    : hub_(io, {[this](int client) { arrived(client); },
                [this](int client, const Message& message) { said(client, message); },
                [this](int client) { left(client); }}) {}

LiveView::~LiveView() {
  if (editor_) editor_->stop();
  if (loop_) loop_->stop();
}

void LiveView::begin(std::unique_ptr<Session> session, const ViewState& first) {
  session_ = std::move(session);
  editor_ = std::make_unique<Editor>(session_.get(), &hub_, [this] { loop_->wake(); });
  loop_ = std::make_unique<ViewLoop>([this] { return editor_->made(); }, &hub_, first,
                                     [this](const auto& camera) { editor_->look_from(camera); });
  editor_->start();
  hub_.tell_all(editor_->scene_text());
}

LiveView::Counts LiveView::counts() const {
  if (!loop_) return {};
  return {loop_->counts(), editor_->steps()};
}

void LiveView::arrived(int client) {
  hub_.tell(client, welcome_reply(client, loop_ ? "ready" : "loading"));
  if (!loop_) return;
  hub_.tell(client, editor_->scene_text());
  loop_->wake();
}

void LiveView::said(int client, const Message& message) {
  if (!loop_) return hub_.tell(client, error_reply("the scene is still being loaded"));
  const bool taken = is_edit(message.request)
                         ? editor_->post(client, message.number, message.request)
                         : loop_->post(client, message.number, message.request);
  if (!taken) hub_.tell(client, error_reply("too much at a time; this was not done"));
}

void LiveView::left(int client) {
  if (!loop_) return;
  loop_->forget(client);
  editor_->forget(client);
}

}  // namespace lte::infer::view
