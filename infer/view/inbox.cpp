#include "infer/view/inbox.h"

#include <algorithm>
#include <utility>

namespace lte::infer::view {
namespace {

/// What comes before it must not be mixed with what comes after it.
bool is_barrier(const Request& request) {
  return is_any<Undo, Redo, Reset, Save, PickAt, CopyObject, RemoveObject, AddLamp, RemoveLamp>(
      request);
}

void merge(const ChangeView& later, ChangeView* view) {
  if (later.shown) view->shown = later.shown;
  if (later.ev) view->ev = later.ev;
  if (later.curve) view->curve = later.curve;
  if (later.size) view->size = later.size;
  view->meter = view->meter || later.meter;
}

}  // namespace

/// Puts a request in the place of one that it makes void. A question of a page is not.
bool Inbox::replace(const Pending& pending) {
  for (auto at = pending_.rbegin(); at != pending_.rend(); ++at) {
    if (is_barrier(at->request)) return false;
    if (std::holds_alternative<MoveCamera>(pending.request) &&
        std::holds_alternative<MoveCamera>(at->request)) {
      *at = pending;
      return true;
    }
    const auto* later = std::get_if<ChangeView>(&pending.request);
    if (auto* view = std::get_if<ChangeView>(&at->request); later != nullptr && view != nullptr) {
      merge(*later, view);
      return true;
    }
    const auto* edit = std::get_if<MakeEdit>(&pending.request);
    const auto* before = std::get_if<MakeEdit>(&at->request);
    if (edit != nullptr && before != nullptr && same_target(edit->edit, before->edit) &&
        edit->gesture == before->gesture && pending.client == at->client) {
      *at = pending;
      return true;
    }
  }
  return false;
}

bool Inbox::post(int client, int64_t number, const Request& request) {
  {
    const std::lock_guard lock(mutex_);
    const Pending pending{client, request};
    if (!is_barrier(request) && replace(pending)) {
      last_number_[client] = number;
    } else {
      if (pending_.size() >= kMaxPending) return false;
      pending_.push_back(pending);
      last_number_[client] = number;
    }
  }
  changed_.notify_all();
  return true;
}

void Inbox::forget(int client) {
  const std::lock_guard lock(mutex_);
  last_number_.erase(client);
  std::erase_if(pending_, [&](const Pending& pending) {
    const bool asks = std::holds_alternative<PickAt>(pending.request) ||
                      std::holds_alternative<Save>(pending.request);
    return asks && pending.client == client;
  });
}

void Inbox::wake() {
  {
    const std::lock_guard lock(mutex_);
    woken_ = true;
  }
  changed_.notify_all();
}

Inbox::Batch Inbox::take(std::chrono::milliseconds most) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, most, [&] { return woken_ || !pending_.empty(); });
  woken_ = false;
  return {std::exchange(pending_, {}), last_number_};
}

bool Inbox::waiting() const {
  const std::lock_guard lock(mutex_);
  return woken_ || !pending_.empty();
}

}  // namespace lte::infer::view
