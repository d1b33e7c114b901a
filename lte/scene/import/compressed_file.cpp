#include "lte/scene/import/compressed_file.h"

#include <algorithm>
#include <array>
#include <climits>

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

std::string inflate_all(const std::string& name, std::string_view packed, size_t limit_bytes) {
  Inflater inflater;
  z_stream& z = inflater.stream;
  // 15 bits of window, + 16: a gzip header and its checksum are expected.
  LTE_CHECK(inflateInit2(&z, 15 + 16) == Z_OK, name, ": cannot start zlib");
  inflater.open = true;
  std::string out;
  std::array<char, 1 << 16> buffer;
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
    LTE_CHECK(out.size() <= limit_bytes, name, ": inflates to more than the limit of ", limit_bytes,
              " bytes");
    ended = status == Z_STREAM_END;
    if (ended) continue;
    LTE_CHECK(status == Z_OK || status == Z_BUF_ERROR, name,
              ": damaged gzip: ", z.msg != nullptr ? z.msg : "zlib gives no reason");
    LTE_CHECK(z.avail_in > 0 || next < packed.size() || z.avail_out == 0, name, ": truncated gzip");
  }
}

}  // namespace

CompressedFile::CompressedFile(const std::filesystem::path& path, size_t limit_bytes) {
  const std::string name = path.string();
  std::error_code error;
  LTE_CHECK(std::filesystem::exists(path, error), name, ": no such file");
  LTE_CHECK(!std::filesystem::is_directory(path, error), name, ": is a directory");
  map_ = std::make_unique<MappedFile>(path);
  text_ = {reinterpret_cast<const char*>(map_->data()), map_->size()};
  if (text_.starts_with("\x1f\x8b")) {
    inflated_ = inflate_all(name, text_, limit_bytes);
    text_ = inflated_;
    map_.reset();
  }
}

}  // namespace lte::scene
