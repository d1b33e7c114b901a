// Files that are broken or hostile: each must be refused by name, none may crash the reader.
#include <cstring>
#include <optional>

#include <gmock/gmock.h>

#include "lte/base/random.h"
#include "lte/base/safetensors.h"
#include "tests/support/temp_dir.h"

namespace lte {
namespace {

using test::TempDir;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

std::string file_bytes(const std::string& header, const std::string& data) {
  std::string bytes(8, '\0');
  const uint64_t size = header.size();
  std::memcpy(bytes.data(), &size, 8);
  return bytes + header + data;
}

/// Pads the header as a writer would, so that alignment is not what fails.
std::string aligned(std::string header, const std::string& data) {
  header.append((64 - (8 + header.size()) % 64) % 64, ' ');
  return file_bytes(header, data);
}

/// What the reader says to `bytes`, or nothing if it takes them.
std::optional<std::string> refusal(const std::string& bytes) {
  static const TempDir dir;
  test::write_text(dir / "bad.safetensors", bytes);
  try {
    const SafetensorsFile file(dir / "bad.safetensors");
    return std::nullopt;
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), StartsWith((dir / "bad.safetensors").string()));
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    return error.what();
  }
}

std::string error_for(const std::string& header, const std::string& data) {
  return refusal(aligned(header, data)).value_or("accepted");
}

/// A header of one F32 tensor "x" with this shape and range.
std::string one(const std::string& shape, const std::string& offsets) {
  return R"({"x": {"dtype": "F32", "shape": )" + shape + R"(, "data_offsets": )" + offsets + "}}";
}

const std::string kFour(4, 'd');

TEST(SafetensorsErrors, HeaderMustFitTheFile) {
  EXPECT_THAT(*refusal(""), HasSubstr("only 0 bytes"));
  EXPECT_THAT(*refusal("1234567"), HasSubstr("only 7 bytes"));
  std::string huge = file_bytes("{}", "");
  std::memset(huge.data(), 0xff, 8);
  EXPECT_THAT(*refusal(huge), HasSubstr("a header of 18446744073709551615 bytes"));
  EXPECT_THAT(*refusal(file_bytes("{}", "").substr(0, 9)), HasSubstr("truncated"));
}

TEST(SafetensorsErrors, HeaderMustBeAJsonMapWithoutRepeatedKeys) {
  EXPECT_THAT(*refusal(file_bytes("", "")), HasSubstr("not JSON"));
  EXPECT_THAT(*refusal(file_bytes("{\"x\": ", "")), HasSubstr("not JSON"));
  EXPECT_THAT(*refusal(file_bytes("[]", "")), HasSubstr("not a JSON object"));
  EXPECT_THAT(*refusal(file_bytes("{\"\xff\": 1}", "")), HasSubstr("not JSON"));
  EXPECT_THAT(*refusal(file_bytes(std::string(1'000'000, '['), "")), HasSubstr("nested too deep"));
  const std::string x = R"("x": {"dtype": "F32", "shape": [1], "data_offsets": [0, 4]})";
  EXPECT_THAT(error_for("{" + x + ", " + x + "}", kFour), HasSubstr("\"x\" stands there twice"));
  EXPECT_THAT(
      error_for(R"({"x": {"dtype": "F32", "dtype": "I32", "shape": [1], "data_offsets": [0, 4]}})",
                kFour),
      HasSubstr("\"dtype\" stands there twice"));
}

TEST(SafetensorsErrors, TensorsMustBeDescribedInFull) {
  EXPECT_EQ(error_for(one("[1]", "[0, 4]"), kFour), "accepted");
  EXPECT_THAT(error_for(R"({"x": 3})", ""),
              HasSubstr("tensor \"x\": expected dtype, shape and data_offsets"));
  EXPECT_THAT(error_for(R"({"x": {"dtype": "F32", "shape": [1]}})", kFour),
              HasSubstr("expected dtype"));
  EXPECT_THAT(error_for(R"({"x": {"dtype": "F8", "shape": [1], "data_offsets": [0, 4]}})", kFour),
              HasSubstr("dtype \"F8\" is none of"));
  EXPECT_THAT(error_for(R"({"x": {"dtype": 4, "shape": [1], "data_offsets": [0, 4]}})", kFour),
              HasSubstr("dtype 4"));
  EXPECT_THAT(error_for(R"({"a\nb": 3})", ""), HasSubstr("\"a\\nb\""));
}

TEST(SafetensorsErrors, ShapesMustBeCounts) {
  for (const char* shape :
       {"[-1]", "[1.0]", "[\"1\"]", "[null]", "[18446744073709551615]", "[1e3]"}) {
    EXPECT_THAT(error_for(one(shape, "[0, 4]"), kFour), HasSubstr("expected non-negative integers"))
        << shape;
  }
  EXPECT_THAT(error_for(one("1", "[0, 4]"), kFour), HasSubstr("shape is not a list"));
  EXPECT_THAT(error_for(one("[4611686018427387904]", "[0, 4]"), kFour), HasSubstr("too large"));
  // The product wraps to 0 in 64 bits.
  EXPECT_THAT(error_for(one("[4294967296, 4294967296]", "[0, 0]"), ""), HasSubstr("too large"));
  // A zero makes it empty whatever the others are, but not if the others overflow.
  EXPECT_EQ(error_for(one("[0, 1000000]", "[0, 0]"), ""), "accepted");
}

TEST(SafetensorsErrors, RangesMustTileTheData) {
  for (const char* offsets :
       {"[4, 0]", "[0, 3]", "[0, 8]", "[0]", "[0, 4, 8]", "4", "[0.0, 4.0]", "[-4, 0]"}) {
    EXPECT_THAT(error_for(one("[1]", offsets), std::string(8, 'd')), HasSubstr("data_offsets"))
        << offsets;
  }
  EXPECT_THAT(error_for(one("[1]", "[18446744073709551612, 0]"), kFour), HasSubstr("data_offsets"));
  EXPECT_THAT(error_for(one("[1]", "[4, 8]"), std::string(8, 'd')), HasSubstr("(hole)"));
  EXPECT_THAT(error_for(one("[2]", "[0, 8]"), kFour), HasSubstr("truncated"));
  EXPECT_THAT(error_for(one("[1]", "[0, 4]"), kFour + "x"),
              HasSubstr("1 bytes behind the last tensor"));
  EXPECT_THAT(error_for(R"({"x": {"dtype": "U8", "shape": [4], "data_offsets": [0, 4]},
                            "y": {"dtype": "U8", "shape": [4], "data_offsets": [2, 6]}})",
                        "123456"),
              AllOf(HasSubstr("tensor \"y\""), HasSubstr("(overlap)")));
}

TEST(SafetensorsErrors, DataMustBeAlignedToItsElements) {
  EXPECT_THAT(*refusal(file_bytes(
                  one("[1]", "[0, 4]") + (one("[1]", "[0, 4]").size() % 4 == 0 ? " " : ""), kFour)),
              HasSubstr("not a multiple of its element's 4 bytes"));
}

TEST(SafetensorsErrors, MetadataMustBeTexts) {
  EXPECT_THAT(error_for(R"({"__metadata__": 3})", ""), HasSubstr("__metadata__"));
  EXPECT_THAT(error_for(R"({"__metadata__": {"k": 3}})", ""), HasSubstr("metadata \"k\""));
}

/// A good file with two tensors and metadata.
std::string good_bytes() {
  const TempDir dir;
  const std::vector<float> values = {1, 2, 3, 4, 5};
  SafetensorsWriter writer;
  writer.add("a", {5}, values.data());
  writer.add("b", {2, 2}, values.data());
  writer.set_metadata("k", "v");
  writer.write(dir / "good");
  return read_file(dir / "good");
}

TEST(SafetensorsErrors, EveryTruncationIsRefused) {
  const std::string good = good_bytes();
  ASSERT_FALSE(refusal(good).has_value());
  for (size_t size = 0; size < good.size(); ++size)
    EXPECT_TRUE(refusal(good.substr(0, size)).has_value()) << size;
}

TEST(SafetensorsErrors, ChangedBytesNeverReachOutsideTheFile) {
  const std::string good = good_bytes();
  Rng rng(11);
  int refused = 0;
  static const TempDir dir;
  for (int trial = 0; trial < 1500; ++trial) {
    std::string bad = good;
    for (uint64_t change = 0; change <= rng.below(3); ++change) {
      bad[rng.below(bad.size() - 36)] = static_cast<char>(rng.next_u32());
    }
    test::write_text(dir / "changed", bad);
    try {
      const SafetensorsFile file(dir / "changed");
      double sum = 0;  // reads every byte a view offers
      for (const auto& [name, tensor] : file.tensors()) {
        for (size_t i = 0; i < tensor.size_bytes(); ++i) sum += static_cast<double>(tensor.data[i]);
      }
      EXPECT_GE(sum, 0);
    } catch (const Error&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 500);
}

}  // namespace
}  // namespace lte
