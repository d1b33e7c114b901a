#include "lte/base/png.h"

#include <algorithm>
#include <array>

#include "lte/base/check.h"

namespace lte {
namespace {

using Bytes = std::vector<unsigned char>;
using Table = std::array<uint32_t, 256>;

constexpr Table crc_table(uint32_t reflected_polynomial) {
  Table out{};
  for (uint32_t i = 0; i < 256; ++i) {
    uint32_t value = i;
    for (int bit = 0; bit < 8; ++bit)
      value = value & 1 ? value >> 1 ^ reflected_polynomial : value >> 1;
    out[i] = value;
  }
  return out;
}

uint32_t crc(const Table& table, std::span<const unsigned char> bytes) {
  uint32_t value = 0xFFFFFFFF;
  for (const unsigned char byte : bytes) value = table[(value ^ byte) & 0xFF] ^ value >> 8;
  return ~value;
}

void append_big_endian(uint32_t value, Bytes* out) {
  for (int shift = 24; shift >= 0; shift -= 8)
    out->push_back(static_cast<unsigned char>(value >> shift));
}

void append_chunk(const char* name, const Bytes& body, Bytes* out) {
  append_big_endian(static_cast<uint32_t>(body.size()), out);
  Bytes checked(name, name + 4);
  checked.insert(checked.end(), body.begin(), body.end());
  out->insert(out->end(), checked.begin(), checked.end());
  append_big_endian(crc32(checked), out);
}

/// A zlib stream (RFC 1950) of stored blocks (RFC 1951, 3.2.4).
Bytes stored_stream(const Bytes& data) {
  constexpr size_t kBlock = 65535;
  Bytes out = {0x78, 0x01};
  for (size_t begin = 0; begin < data.size(); begin += kBlock) {
    const size_t size = std::min(kBlock, data.size() - begin);
    const auto low = static_cast<unsigned char>(size), high = static_cast<unsigned char>(size >> 8);
    const unsigned char last = begin + size == data.size() ? 1 : 0;
    for (const int byte : {int{last}, int{low}, int{high}, ~low & 0xFF, ~high & 0xFF})
      out.push_back(static_cast<unsigned char>(byte));
    const auto from = data.begin() + static_cast<std::ptrdiff_t>(begin);
    out.insert(out.end(), from, from + static_cast<std::ptrdiff_t>(size));
  }
  uint32_t a = 1, b = 0;  // Adler-32
  for (const unsigned char byte : data) a = (a + byte) % 65521, b = (b + a) % 65521;
  append_big_endian(b << 16 | a, &out);
  return out;
}

}  // namespace

uint32_t crc32(std::span<const unsigned char> bytes) {
  static constexpr Table kTable = crc_table(0xEDB88320);
  return crc(kTable, bytes);
}

uint32_t crc32c(std::span<const unsigned char> bytes) {
  static constexpr Table kTable = crc_table(0x82F63B78);
  return crc(kTable, bytes);
}

Bytes encode_stored_png(int width, int height, std::span<const unsigned char> rgb) {
  LTE_CHECK(width > 0 && height > 0, "PNG: expected positive sizes, got ", width, " x ", height);
  const size_t stride = 3 * static_cast<size_t>(width);
  LTE_CHECK(rgb.size() == stride * static_cast<size_t>(height), "PNG: ", rgb.size(), " bytes for ",
            width, " x ", height, " pixels");
  Bytes out = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
  Bytes header;
  append_big_endian(static_cast<uint32_t>(width), &header);
  append_big_endian(static_cast<uint32_t>(height), &header);
  header.insert(header.end(), {8, 2, 0, 0, 0});  // 8 bits, RGB, deflate, no filter, not interlaced
  append_chunk("IHDR", header, &out);
  Bytes rows;
  for (size_t y = 0; y < static_cast<size_t>(height); ++y) {
    rows.push_back(0);  // no filter
    const auto row = rgb.subspan(y * stride, stride);
    rows.insert(rows.end(), row.begin(), row.end());
  }
  append_chunk("IDAT", stored_stream(rows), &out);
  append_chunk("IEND", {}, &out);
  return out;
}

}  // namespace lte
