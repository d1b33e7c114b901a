// Damage of files that have a checksum: every single bit, and whole blocks.
#include "lte/base/checksum.h"

#include <cstring>
#include <fstream>
#include <set>
#include <vector>

#include <gmock/gmock.h>

#include "lte/base/file.h"
#include "lte/base/safetensors.h"
#include "tests/support/temp_dir.h"

namespace lte {
namespace {

using test::error_of;
using testing::AllOf;
using testing::HasSubstr;

TEST(Checksum, EveryBitAndEveryLengthCounts) {
  const std::vector<unsigned char> zeros(200);
  const auto of = [](const std::vector<unsigned char>& bytes, size_t size) {
    Checksum sum;
    sum.add(bytes.data(), size);
    return sum.value();
  };
  std::set<uint64_t> lengths;
  for (size_t size = 0; size <= zeros.size(); ++size) lengths.insert(of(zeros, size));
  EXPECT_EQ(lengths.size(), zeros.size() + 1);
  const uint64_t whole = of(zeros, zeros.size());
  for (size_t bit = 0; bit < 8 * zeros.size(); ++bit) {
    std::vector<unsigned char> bytes = zeros;
    bytes[bit / 8] ^= static_cast<unsigned char>(1 << bit % 8);
    EXPECT_NE(of(bytes, bytes.size()), whole) << "bit " << bit;
  }
}

TEST(Checksum, OrderAndCutsCount) {
  const auto of = [](std::initializer_list<const char*> parts) {
    Checksum sum;
    for (const char* part : parts) sum.add(std::string_view(part));
    return sum.text();
  };
  EXPECT_EQ(of({"ab", "c"}), of({"ab", "c"}));
  EXPECT_NE(of({"ab", "c"}), of({"c", "ab"}));
  EXPECT_NE(of({"ab", "c"}), of({"a", "bc"}));
  EXPECT_NE(of({}), of({""}));
}

class DamagedFile : public testing::Test {
 protected:
  DamagedFile() {
    const std::vector<float> values = {1, -2, 0.5f, 0};
    const std::vector<uint8_t> odd = {1, 2, 3};
    SafetensorsWriter writer;
    writer.add("weights", {2, 2}, values.data());
    writer.add("odd", {3}, odd.data());
    writer.add("none", {0}, static_cast<const float*>(nullptr));
    writer.set_metadata("name", "a \"lte_checksum\":\"0000000000000000\" b");
    writer.write(dir_ / "a.safetensors");
    bytes_ = read_file(dir_ / "a.safetensors");
  }
  std::filesystem::path damaged(const std::string& bytes) const {
    test::write_text(dir_ / "b.safetensors", bytes);
    return dir_ / "b.safetensors";
  }
  test::TempDir dir_;
  std::string bytes_;
};

/// Refused, or of the same tensors with the same metadata: a flip in the name of the checksum's own
/// key leaves a file that has none.
TEST_F(DamagedFile, EveryFlippedBitIsRefusedOrHarmless) {
  const SafetensorsFile whole(dir_ / "a.safetensors");
  EXPECT_NO_THROW(whole.verify());
  size_t refused = 0, harmless = 0;
  for (size_t bit = 0; bit < 8 * bytes_.size(); ++bit) {
    std::string bytes = bytes_;
    bytes[bit / 8] = static_cast<char>(bytes[bit / 8] ^ (1 << bit % 8));
    try {
      const SafetensorsFile file(damaged(bytes));
      file.verify();
      ++harmless;
      EXPECT_FALSE(file.metadata().contains(kChecksumKey)) << "bit " << bit;
      EXPECT_EQ(file.metadata("name"), whole.metadata("name")) << "bit " << bit;
      ASSERT_EQ(file.tensors().size(), whole.tensors().size()) << "bit " << bit;
      for (const auto& [name, tensor] : whole.tensors()) {
        EXPECT_EQ(file.at(name).shape, tensor.shape) << "bit " << bit;
        EXPECT_EQ(std::memcmp(file.at(name).data, tensor.data, tensor.size_bytes()), 0)
            << "bit " << bit;
      }
    } catch (const Error& error) {
      ++refused;
      EXPECT_THAT(error.what(), HasSubstr("b.safetensors"));
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  }
  EXPECT_LE(harmless, 8 * std::strlen(kChecksumKey));
  EXPECT_EQ(refused + harmless, 8 * bytes_.size());
}

TEST_F(DamagedFile, TheMessageSaysWhatIsWrong) {
  std::string bytes = bytes_;
  bytes.back() = 7;
  const SafetensorsFile file(damaged(bytes));
  EXPECT_THAT(error_of([&] { file.verify(); }),
              AllOf(HasSubstr("b.safetensors"), HasSubstr("damaged"), HasSubstr("checksum")));
}

TEST_F(DamagedFile, FilesOfOtherProgramsHaveNoChecksumAndPass) {
  const std::string header =
      R"({"x": {"dtype": "F32", "shape": [1], "data_offsets": [0, 4]}, "__metadata__": {"a": "b"}})";
  std::string bytes(8, '\0');
  bytes += header + std::string((8 - header.size() % 8) % 8, ' ');
  const uint64_t size = bytes.size() - 8;
  std::memcpy(bytes.data(), &size, 8);
  EXPECT_NO_THROW(SafetensorsFile(damaged(bytes + "dddd")).verify());
}

/// A file read and written again, with the metadata it had, gets the checksum of what it is now.
TEST_F(DamagedFile, CopyingMetadataDoesNotCopyTheChecksum) {
  const SafetensorsFile whole(dir_ / "a.safetensors");
  const std::vector<float> others = {4, 3, 2, 1};
  SafetensorsWriter writer;
  writer.add("weights", {2, 2}, others.data());
  for (const auto& [key, value] : whole.metadata()) writer.set_metadata(key, value);
  writer.write(dir_ / "c.safetensors");
  const SafetensorsFile copy(dir_ / "c.safetensors");
  EXPECT_NO_THROW(copy.verify());
  EXPECT_NE(copy.metadata(kChecksumKey), whole.metadata(kChecksumKey));
}

}  // namespace
}  // namespace lte
