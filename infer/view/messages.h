// What a page says to the server: one JSON object a text frame (docs/view.md has the table).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "infer/view/view_state.h"
#include "lte/scene/scene.h"

namespace lte::infer::view {

/// Of the messages; a page of another version is told to reload.
inline constexpr int kProtocol = 1;
/// A frame above this is refused before it is read to its end.
inline constexpr size_t kMaxMessageBytes = 16 * 1024;
/// Of a word in a message.
inline constexpr size_t kMaxWordBytes = 40;

/// The first message of every page.
struct Hello {
  int protocol = 0;
};
struct MoveCamera {
  scene::Camera camera;
};
/// Changes what is shown of the scene; what is missing stays.
struct ChangeView {
  std::optional<Shown> shown;
  std::optional<float> ev;
  std::optional<ToneCurve> curve;
  std::optional<PictureSize> size;
  bool meter = false;  ///< choose the base exposure anew by the picture
};
/// Edits of one gesture, such as a drag, are undone together.
struct MakeEdit {
  PageEdit edit;
  int64_t gesture = 0;
};
/// Places another object like one, so many metres from it.
struct CopyObject {
  int object = 0;
  Vec3 move;
};
struct RemoveObject {
  int object = 0;
};
/// Adds a point or spot light.
struct AddLamp {
  scene::LightKind kind = scene::LightKind::Point;
  Vec3 position, direction{0, -1, 0};
  std::optional<Rgb> intensity;  ///< W/sr; by default as strong as the scene's own lamps
};
struct RemoveLamp {
  int light = 0;
};
/// Asks what is seen at a point of the picture, (0, 0) top left, (1, 1) bottom right.
struct PickAt {
  float x = 0, y = 0;
};
enum class SaveFormat { Png, Exr, Camera, Glb };
struct Save {
  SaveFormat format = SaveFormat::Png;
};
struct Undo {};
struct Redo {};
/// Takes all edits back; can be undone.
struct Reset {};
/// The page has shown this picture: the next one may be sent.
struct Shows {
  int64_t picture = 0;
};

using Request = std::variant<Hello, MoveCamera, ChangeView, MakeEdit, CopyObject, RemoveObject,
                             AddLamp, RemoveLamp, PickAt, Save, Undo, Redo, Reset, Shows>;

/// Whether a request is one of these.
template <typename... Types>
bool is_any(const Request& request) {
  return (std::holds_alternative<Types>(request) || ...);
}

struct Message {
  int64_t number = 0;  ///< rises from message to message of a page
  Request request;
};

/// Reads one message.
/// Whether light 7 exists is not its business.
/// @throws lte::Error in one line that names the key, for anything but a well-formed message: other
///         JSON, an unknown type or key, a value out of its range
Message parse_message(std::string_view text);

constexpr EnumNames<SaveFormat, 4> enum_names(SaveFormat) {
  return {{{SaveFormat::Png, "png"},
           {SaveFormat::Exr, "exr"},
           {SaveFormat::Camera, "camera"},
           {SaveFormat::Glb, "glb"}}};
}

}  // namespace lte::infer::view
