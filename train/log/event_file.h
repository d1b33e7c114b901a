// Event files of TensorBoard: curves and pictures of a run, without TensorFlow.
//
// A file is a sequence of TFRecords (length, masked CRC-32C of it, data, masked CRC-32C of the
// data), each a protocol buffer `tensorflow.Event`. Every session writes a file of its own. It
// starts with a session-log event whose step tells readers to drop what earlier sessions recorded
// from there on: steps that a resumed run does again.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "train/log/append_file.h"

namespace lte::train {

using NamedValues = std::vector<std::pair<std::string, double>>;

/// The bytes of events, and of the record around one.
namespace event {

/// `file_version`: the first event of a file.
std::string version(double wall_time);
/// `session_log` START: events of `step` or later that were recorded before this one do not count.
std::string session_start(double wall_time, int64_t step);
/// `summary` of values; tags as given.
std::string scalars(double wall_time, int64_t step, const NamedValues& values);
/// `summary` of one RGB picture.
std::string image(double wall_time, int64_t step, const std::string& tag, int width, int height,
                  std::span<const unsigned char> png);
/// The TFRecord of `data`.
std::string record(const std::string& data);

}  // namespace event

class EventFile {
 public:
  /// Creates <folder>/events.out.tfevents.<seconds>.<host>.<process>. Its name sorts behind those
  /// of the files that are there, because readers take the files of a folder by name.
  /// @param resume_step  steps done before this session; a new run has 0
  /// @throws lte::Error naming the file.
  EventFile(const std::filesystem::path& folder, int64_t resume_step);

  /// Says what a full disk has kept out for good.
  ~EventFile();
  EventFile(EventFile&&) = default;
  EventFile& operator=(EventFile&&) = delete;

  /// Each call leaves whole records on disk. On a full one values wait for the next call that finds
  /// room, and pictures are left out.
  void scalars(int64_t step, const NamedValues& values);
  void image(int64_t step, const std::string& tag, int width, int height,
             std::span<const unsigned char> png);

 private:
  bool append(const std::string& data);

  std::filesystem::path path_;
  std::unique_ptr<AppendFile> file_;
  std::string waiting_;   ///< records
  int64_t left_out_ = 0;  ///< pictures
};

}  // namespace lte::train
