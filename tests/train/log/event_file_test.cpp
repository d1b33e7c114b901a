// Event files byte by byte: what TensorBoard's own writer makes of the same events (its event_pb2
// and RecordWriter, version 2.21).
#include "train/log/event_file.h"

#include <algorithm>
#include <fstream>
#include <numeric>
#include <sstream>

#include "tests/train/support.h"
#include "train/log/run_log.h"

namespace lte::train {
namespace {

constexpr double kTime = 1700000000.25;

std::string hex(const std::string& bytes) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string out;
  for (const char byte : bytes) {
    out += kDigits[static_cast<unsigned char>(byte) >> 4];
    out += kDigits[static_cast<unsigned char>(byte) & 15];
  }
  return out;
}

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

std::vector<std::filesystem::path> files_of(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> out;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) out.push_back(entry.path());
  std::sort(out.begin(), out.end());
  return out;
}

TEST(Event, VersionAndSessionStartAreTensorBoardsBytes) {
  EXPECT_EQ(hex(event::record(event::version(kTime))),
            "1800000000000000a37f4b220900001040fc54d9411a0d627261696e2e4576656e743a32338d2fe9");
  EXPECT_EQ(hex(event::record(event::session_start(kTime, 301))),
            "100000000000000095fbfe180900001040fc54d94110ad023a020801cb79b93b");
}

TEST(Event, ScalarsAreTensorBoardsBytes) {
  EXPECT_EQ(
      hex(event::record(event::scalars(kTime, 300, {{"train/loss", 0.125}, {"val/psnr", -3.5}}))),
      "3200000000000000241956ec0900001040fc54d94110ac022a240a110a0a747261696e2f6c6f7373150000003e"
      "0a0f0a0876616c2f70736e7215000060c083303132");
}

TEST(Event, ImagesAreTensorBoardsBytes) {
  std::vector<unsigned char> png(199);
  std::iota(png.begin(), png.end(), static_cast<unsigned char>(1));
  const std::string found = event::record(event::image(kTime, 2'000'000, "preview/a", 200, 2, png));
  std::string expected =
      "f200000000000000265d02960900001040fc54d9411080897a2ae2010adf010a09707265766965772f6122d10108"
      "0210c801180322c701";
  expected += hex(std::string(png.begin(), png.end()));
  EXPECT_EQ(hex(found), expected + "5b14ab80");
}

TEST(EventFile, BeginsWithItsVersionAndASessionThatDropsWhatIsDoneAgain) {
  const test::TempDir dir;
  EventFile file(dir / "events", 300);
  file.scalars(301, {{"train/loss", 1}});
  const auto files = files_of(dir / "events");
  ASSERT_EQ(files.size(), 1u);
  EXPECT_NE(files[0].filename().string().find("events.out.tfevents."), std::string::npos);
  const std::string bytes = bytes_of(files[0]);
  EXPECT_NE(bytes.find("brain.Event:2"), std::string::npos);
  // Step 301 (varint ad 02), session_log { status: START }.
  EXPECT_NE(hex(bytes).find("10ad023a020801"), std::string::npos);
  EXPECT_EQ(bytes.size(),
            event::record(event::version(kTime)).size() +
                event::record(event::session_start(kTime, 301)).size() +
                event::record(event::scalars(kTime, 301, {{"train/loss", 1}})).size());
}

TEST(EventFile, SortsBehindThoseOfEarlierSessions) {
  const test::TempDir dir;
  std::string last;
  for (int session = 0; session < 3; ++session) {  // within one second
    EventFile(dir.path(), session).scalars(session, {{"a", session}});
    const auto files = files_of(dir.path());
    ASSERT_EQ(files.size(), static_cast<size_t>(session) + 1);
    EXPECT_GT(files.back().string(), last);
    last = files.back().string();
    EXPECT_NE(
        hex(bytes_of(files.back())).find(hex(event::session_start(kTime, session + 1)).substr(18)),
        std::string::npos)
        << "the newest file is the one of this session";
  }
}

TEST(EventFile, AFolderThatCannotBeMadeIsNamed) {
  test::expect_error([] { EventFile("/proc/nowhere", 0); }, {"/proc/nowhere"});
}

TEST(RunLog, WritesItsFiguresAsEventsToo) {
  const test::TempDir dir;
  RunLog log(dir / "log.jsonl", 0);
  log.add_events(dir / "events", 0);
  log.write(10, {{"loss", 0.5}, {"val_psnr", 30}}, {{"room", 0.25}});
  EXPECT_EQ(test::lines_of(dir / "log.jsonl"),
            (std::vector<std::string>{
                "{\"step\":10,\"loss\":0.5,\"val_psnr\":30.0,\"val_scenes\":{\"room\":0.25}}"}));
  const std::string bytes = bytes_of(files_of(dir / "events")[0]);
  EXPECT_NE(bytes.find("train/loss"), std::string::npos);
  EXPECT_NE(bytes.find("val/psnr"), std::string::npos);
  EXPECT_EQ(bytes.find("room"), std::string::npos);
}

}  // namespace
}  // namespace lte::train
