#include "lte/scene/import/compressed_file.h"

#include <algorithm>
#include <array>
#include <climits>
#include <cstdint>
#include <utility>

#include <zlib.h>

#include "lte/base/check.h"

namespace lte::scene {
namespace {

/// Ends zlib's stream whatever happens.
struct Inflater {
  z_stream stream{};
  bool open = false;
  ~Inflater() {
    if (open) inflateEnd(&stream);
  }
};

/// The length that stands at the end of a gzip file, modulo 2^32. It may be a lie, or that of the
/// last of several: a hint for what to set aside, which costs nothing until it is filled.
size_t promised_length(std::string_view packed) {
  if (packed.size() < 18) return 0;
  size_t length = 0;
  for (size_t i = 0; i < 4; ++i)
    length |= size_t{static_cast<unsigned char>(packed[packed.size() - 4 + i])} << (8 * i);
  return length;
}

std::string inflate_all(const std::string& name, std::string_view packed, int64_t left,
                        int64_t limit) {
  Inflater inflater;
  z_stream& z = inflater.stream;
  // 15 bits of window, + 16: a gzip header and its checksum are expected.
  LTE_CHECK(inflateInit2(&z, 15 + 16) == Z_OK, name, ": cannot start zlib");
  inflater.open = true;
  std::string out;
  const auto most = static_cast<size_t>(std::max<int64_t>(left, 0));
  std::array<char, 1 << 16> buffer;
  out.reserve(std::min(promised_length(packed), most) + buffer.size());
  size_t next = 0;
  bool ended = false;
  while (true) {
    if (z.avail_in == 0 && next < packed.size()) {
      const size_t count = std::min<size_t>(packed.size() - next, INT_MAX);
      z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data() + next));
      z.avail_in = static_cast<uInt>(count);
      next += count;
    }
    if (ended) {
      // gzip files may be concatenated; anything else behind the end is padding.
      if (z.avail_in < 2 || z.next_in[0] != 0x1f || z.next_in[1] != 0x8b) return out;
      LTE_CHECK(inflateReset(&z) == Z_OK, name, ": cannot restart zlib");
      ended = false;
    }
    z.next_out = reinterpret_cast<Bytef*>(buffer.data());
    z.avail_out = static_cast<uInt>(buffer.size());
    const int status = inflate(&z, Z_NO_FLUSH);
    out.append(buffer.data(), buffer.size() - z.avail_out);
    if (out.size() > most)
      throw OverLimit(concat(name, ": inflates to more than the ", size_text(left),
                             " that are left of the limit \"inflated\" of ", size_text(limit)),
                      "inflated");
    ended = status == Z_STREAM_END;
    if (ended) continue;
    LTE_CHECK(status == Z_OK || status == Z_BUF_ERROR, name,
              ": damaged gzip: ", z.msg != nullptr ? z.msg : "zlib gives no reason");
    LTE_CHECK(z.avail_in > 0 || next < packed.size() || z.avail_out == 0, name, ": truncated gzip");
  }
}

}  // namespace

CompressedFile::CompressedFile(SceneFilePtr file, LoadBudget* budget)
    : file_(std::move(file)), text_(file_->text()) {
  if (!text_.starts_with("\x1f\x8b")) return;
  inflated_ =
      inflate_all(file_->name(), text_, budget->inflated_left(), budget->limits().inflated_bytes);
  budget->add_inflated(static_cast<int64_t>(inflated_.size()), file_->name());
  text_ = inflated_;
}

}  // namespace lte::scene
