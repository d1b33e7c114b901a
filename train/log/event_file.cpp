#include "train/log/event_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cstring>

#include <unistd.h>

#include "lte/base/check.h"
#include "lte/base/crc32c.h"
#include "lte/base/file.h"
#include "lte/base/log.h"

namespace lte::train {
namespace {

constexpr const char* kPrefix = "events.out.tfevents.";

double now() {
  const auto since = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration<double>(since).count();
}

template <typename T>
void append_little_endian(T value, std::string* out) {
  for (size_t i = 0; i < sizeof(T); ++i) out->push_back(static_cast<char>(value >> (8 * i) & 0xFF));
}

// Protocol buffers: a field is its key, number · 8 + wire type, then its value.
enum class Wire : uint8_t { Varint = 0, Fixed64 = 1, Bytes = 2, Fixed32 = 5 };

void append_varint(uint64_t value, std::string* out) {
  for (; value >= 0x80; value >>= 7) out->push_back(static_cast<char>((value & 0x7F) | 0x80));
  out->push_back(static_cast<char>(value));
}
void append_key(uint32_t field, Wire wire, std::string* out) {
  append_varint(field << 3 | static_cast<uint32_t>(wire), out);
}
void append_int(uint32_t field, int64_t value, std::string* out) {
  append_key(field, Wire::Varint, out);
  append_varint(static_cast<uint64_t>(value), out);
}
void append_bytes(uint32_t field, std::string_view value, std::string* out) {
  append_key(field, Wire::Bytes, out);
  append_varint(value.size(), out);
  out->append(value);
}
void append_float(uint32_t field, float value, std::string* out) {
  append_key(field, Wire::Fixed32, out);
  append_little_endian(std::bit_cast<uint32_t>(value), out);
}

/// tensorflow/core/util/event.proto: wall_time = 1, step = 2; a step of 0 is not written, as it is
/// the default.
std::string event_head(double wall_time, int64_t step) {
  std::string out;
  append_key(1, Wire::Fixed64, &out);
  append_little_endian(std::bit_cast<uint64_t>(wall_time), &out);
  if (step != 0) append_int(2, step, &out);
  return out;
}

uint32_t masked_crc(const std::string& data) {
  const uint32_t value = crc32c({reinterpret_cast<const unsigned char*>(data.data()), data.size()});
  return (value >> 15 | value << 17) + 0xA282EAD8U;
}

/// Seconds since 1970, later than in the name of any file of the folder.
int64_t name_seconds(const std::filesystem::path& folder) {
  auto seconds = static_cast<int64_t>(now());
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(kPrefix)) continue;
    seconds = std::max<int64_t>(seconds, std::atoll(name.c_str() + std::strlen(kPrefix)) + 1);
  }
  return seconds;
}

}  // namespace

namespace event {

std::string version(double wall_time) {
  std::string out = event_head(wall_time, 0);
  append_bytes(3, "brain.Event:2", &out);
  return out;
}

std::string session_start(double wall_time, int64_t step) {
  constexpr int64_t kStart = 1;
  std::string log, out = event_head(wall_time, step);
  append_int(1, kStart, &log);
  append_bytes(7, log, &out);
  return out;
}

std::string scalars(double wall_time, int64_t step, const NamedValues& values) {
  std::string summary;
  for (const auto& [tag, value] : values) {
    std::string entry;
    append_bytes(1, tag, &entry);
    append_float(2, static_cast<float>(value), &entry);
    append_bytes(1, entry, &summary);
  }
  std::string out = event_head(wall_time, step);
  append_bytes(5, summary, &out);
  return out;
}

std::string image(double wall_time, int64_t step, const std::string& tag, int width, int height,
                  std::span<const unsigned char> png) {
  constexpr int64_t kRgb = 3;
  std::string picture, entry, summary;
  append_int(1, height, &picture);
  append_int(2, width, &picture);
  append_int(3, kRgb, &picture);
  append_bytes(4, {reinterpret_cast<const char*>(png.data()), png.size()}, &picture);
  append_bytes(1, tag, &entry);
  append_bytes(4, picture, &entry);
  append_bytes(1, entry, &summary);
  std::string out = event_head(wall_time, step);
  append_bytes(5, summary, &out);
  return out;
}

std::string record(const std::string& data) {
  std::string length;
  append_little_endian(static_cast<uint64_t>(data.size()), &length);
  std::string out = length;
  append_little_endian(masked_crc(length), &out);
  out += data;
  append_little_endian(masked_crc(data), &out);
  return out;
}

}  // namespace event

EventFile::EventFile(const std::filesystem::path& folder, int64_t resume_step) {
  make_directory(folder);
  std::array<char, 256> host{};
  if (::gethostname(host.data(), host.size() - 1) != 0) host[0] = '\0';
  path_ = folder / concat(kPrefix, name_seconds(folder), ".", host[0] ? host.data() : "host", ".",
                          ::getpid());
  file_ = std::make_unique<AppendFile>(path_);
  waiting_ = event::record(event::version(now())) +
             event::record(event::session_start(now(), resume_step + 1));
  append("");
}

EventFile::~EventFile() {
  if (!file_) return;  // moved from
  append("");
  if (left_out_ > 0 || !waiting_.empty())
    log_warning(path_.string(), ": ", left_out_, " pictures and ", waiting_.size(),
                " bytes of curves could not be written: ", file_->fault());
}

void EventFile::scalars(int64_t step, const NamedValues& values) {
  const std::string data = event::record(event::scalars(now(), step, values));
  if (!append(data)) waiting_ += data;
}

void EventFile::image(int64_t step, const std::string& tag, int width, int height,
                      std::span<const unsigned char> png) {
  if (!append(event::record(event::image(now(), step, tag, width, height, png)))) ++left_out_;
}

/// Appends what waits, and `data` behind it. If there is no room all that waits stays.
bool EventFile::append(const std::string& data) {
  if (!waiting_.empty()) {
    if (!file_->append(waiting_)) return false;
    waiting_.clear();
  }
  return file_->append(data);
}

}  // namespace lte::train
