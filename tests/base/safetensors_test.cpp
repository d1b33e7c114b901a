#include "lte/base/safetensors.h"

#include <cstring>
#include <numeric>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/support/temp_dir.h"

namespace lte {
namespace {

using test::error_of;
using test::TempDir;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

TEST(Safetensors, RoundTripsEveryDTypeAndMetadata) {
  const TempDir dir;
  std::vector<float> f32(6);
  std::iota(f32.begin(), f32.end(), 0.5f);
  const std::vector<double> f64 = {1e-300, -2};
  const std::vector<int32_t> i32 = {INT32_MIN, 7};
  const std::vector<int64_t> i64 = {INT64_MAX};
  const std::vector<uint8_t> u8 = {1, 2, 255};
  const std::vector<uint16_t> half = {0x3c00, 0xbc00};
  SafetensorsWriter writer;
  writer.add("f32", {2, 3}, f32.data());
  writer.add("f64", {2}, f64.data());
  writer.add("i32", {2, 1}, i32.data());
  writer.add("i64", {}, i64.data());
  writer.add("u8", {3}, u8.data());
  writer.add("f16", {DType::F16, {2}, reinterpret_cast<const std::byte*>(half.data())});
  writer.add("bf16", {DType::BF16, {2}, reinterpret_cast<const std::byte*>(half.data())});
  writer.add("none", {0, 5}, static_cast<const float*>(nullptr));
  writer.set_metadata("tool", "line\n\"quoted\" é");
  writer.write(dir / "a.safetensors");

  const SafetensorsFile file(dir / "a.safetensors");
  EXPECT_EQ(file.tensors().size(), 8u);
  EXPECT_THAT(file.values<float>("f32", {2, 3}), testing::ElementsAreArray(f32));
  EXPECT_THAT(file.values<double>("f64", {-1}), testing::ElementsAreArray(f64));
  EXPECT_THAT(file.values<int32_t>("i32", {2, 1}), testing::ElementsAreArray(i32));
  EXPECT_THAT(file.values<int64_t>("i64", {}), ElementsAre(INT64_MAX));
  EXPECT_THAT(file.values<uint8_t>("u8", {3}), testing::ElementsAreArray(u8));
  EXPECT_TRUE(file.values<float>("none", {0, 5}).empty());
  for (const char* name : {"f16", "bf16"}) {
    EXPECT_EQ(dtype_name(file.at(name).dtype), std::string(name[0] == 'b' ? "BF16" : "F16"));
    EXPECT_EQ(std::memcmp(file.at(name).data, half.data(), 4), 0);
  }
  EXPECT_EQ(file.metadata("tool"), "line\n\"quoted\" é");
  EXPECT_TRUE(file.contains("f32"));
  EXPECT_FALSE(file.contains("f33"));
}

/// The layout the format's specification asks for, read without our reader.
TEST(Safetensors, LayoutIsTheSpecifications) {
  const TempDir dir;
  const std::vector<uint8_t> odd = {9, 8, 7};
  const std::vector<double> wide = {1.5};
  SafetensorsWriter writer;
  writer.add("a_odd", {3}, odd.data());
  writer.add("z_wide", {1}, wide.data());
  writer.set_metadata("k", "v");
  writer.write(dir / "a.safetensors");
  const std::string bytes = read_file(dir / "a.safetensors");
  uint64_t header_size = 0;
  std::memcpy(&header_size, bytes.data(), 8);
  EXPECT_EQ((8 + header_size) % 64, 0u);
  EXPECT_EQ(bytes.size(), 8 + header_size + 11);
  EXPECT_EQ(bytes[8], '{');
  auto header = nlohmann::json::parse(bytes.substr(8, header_size));
  const std::string checksum = header["__metadata__"][kChecksumKey];
  EXPECT_EQ(checksum.size(), 16u);
  EXPECT_EQ(checksum.find_first_not_of("0123456789abcdef"), std::string::npos);
  header["__metadata__"].erase(kChecksumKey);
  const auto expected = nlohmann::json::parse(R"({"__metadata__": {"k": "v"},
    "a_odd": {"dtype": "U8", "shape": [3], "data_offsets": [8, 11]},
    "z_wide": {"dtype": "F64", "shape": [1], "data_offsets": [0, 8]}})");
  EXPECT_EQ(header, expected);
  EXPECT_EQ(std::memcmp(bytes.data() + 8 + header_size, wide.data(), 8), 0);
  EXPECT_EQ(bytes.substr(bytes.size() - 3), "\x09\x08\x07");
}

TEST(Safetensors, SameContentGivesTheSameBytes) {
  const TempDir dir;
  const std::vector<float> values = {1, 2};
  for (const std::string name : {"a", "b"}) {
    SafetensorsWriter writer;
    writer.add(name == "a" ? "x" : "y", {2}, values.data());
    writer.add(name == "a" ? "y" : "x", {2}, values.data());
    writer.set_metadata(name == "a" ? "k" : "l", "v");
    writer.set_metadata(name == "a" ? "l" : "k", "v");
    writer.write(dir / name);
  }
  EXPECT_EQ(read_file(dir / "a"), read_file(dir / "b"));
}

TEST(Safetensors, TensorsAreAlignedToTheirElements) {
  const TempDir dir;
  const std::vector<double> values(8);
  SafetensorsWriter writer;
  writer.add("a", {3}, reinterpret_cast<const uint8_t*>(values.data()));
  writer.add("b", {DType::F16, {3}, reinterpret_cast<const std::byte*>(values.data())});
  writer.add("c", {1}, reinterpret_cast<const float*>(values.data()));
  writer.add("d", {3}, values.data());
  writer.write(dir / "a.safetensors");
  const SafetensorsFile file(dir / "a.safetensors");
  for (const auto& [name, tensor] : file.tensors()) {
    EXPECT_EQ(reinterpret_cast<uintptr_t>(tensor.data) % dtype_size(tensor.dtype), 0u) << name;
  }
}

TEST(Safetensors, EmptyFileIsAFile) {
  const TempDir dir;
  SafetensorsWriter().write(dir / "a.safetensors");
  EXPECT_TRUE(SafetensorsFile(dir / "a.safetensors").tensors().empty());
}

TEST(Safetensors, FileOutlivesCopies) {
  const TempDir dir;
  const float one = 1;
  SafetensorsWriter writer;
  writer.add("x", {1}, &one);
  writer.write(dir / "a.safetensors");
  auto file = std::make_unique<SafetensorsFile>(dir / "a.safetensors");
  const SafetensorsFile copy = *file;
  file.reset();
  EXPECT_EQ(copy.values<float>("x", {1})[0], 1);
}

TEST(Safetensors, AccessorsNameFileAndTensor) {
  const TempDir dir;
  const std::vector<float> values(6);
  SafetensorsWriter writer;
  writer.add("x", {2, 3}, values.data());
  writer.write(dir / "a.safetensors");
  const SafetensorsFile file(dir / "a.safetensors");
  EXPECT_THAT(error_of([&] { file.at("y"); }),
              AllOf(HasSubstr("a.safetensors"), HasSubstr("has no tensor \"y\"")));
  EXPECT_THAT(error_of([&] { file.metadata("k"); }), HasSubstr("has no metadata \"k\""));
  EXPECT_THAT(error_of([&] {
                file.values<double>("x", {2, 3});
              }),
              HasSubstr("tensor \"x\": expected F64 [2, 3], got F32 [2, 3]"));
  EXPECT_THAT(error_of([&] {
                file.values<float>("x", {-1, 4});
              }),
              HasSubstr("expected F32 [-1, 4], got F32 [2, 3]"));
  EXPECT_THAT(error_of([&] { file.values<float>("x", {-1}); }), HasSubstr("expected F32 [-1]"));
}

TEST(SafetensorsWriter, RefusesWhatItCannotWrite) {
  const TempDir dir;
  const float one = 1;
  SafetensorsWriter writer;
  writer.add("x", {1}, &one);
  EXPECT_THAT(error_of([&] { writer.add("x", {1}, &one); }), HasSubstr("added twice"));
  EXPECT_THAT(error_of([&] { writer.add("__metadata__", {1}, &one); }), HasSubstr("reserved"));
  EXPECT_THAT(error_of([&] { writer.add("y", {-1}, &one); }), HasSubstr("bad shape [-1]"));
  EXPECT_THAT(error_of([&] {
                writer.add("y", {int64_t{1} << 40, int64_t{1} << 40}, &one);
              }),
              HasSubstr("bad shape"));
  EXPECT_THAT(error_of([&] { writer.add("y", {1}, static_cast<const float*>(nullptr)); }),
              HasSubstr("no data"));
  EXPECT_THAT(error_of([&] { writer.write(dir / "no/a"); }), HasSubstr("no/a"));
  writer.set_metadata("k", "\xff\xfe");
  EXPECT_THAT(error_of([&] { writer.write(dir / "a"); }), HasSubstr("UTF-8"));
  EXPECT_EQ(dir.count(), 0u);
}

}  // namespace
}  // namespace lte
