#include "lte/image/exr.h"

#include <cmath>
#include <cstring>

#include <Imath/half.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <gmock/gmock.h>

#include "lte/base/file.h"
#include "lte/base/process_memory.h"
#include "tests/image/random_image.h"
#include "tests/support/temp_dir.h"

namespace lte::image {
namespace {

using test::error_of;
using test::random_image;
using test::TempDir;
using testing::AllOf;
using testing::HasSubstr;

/// Channel names that OpenEXR sees in a file.
std::vector<std::string> channels_of(const std::filesystem::path& path) {
  const Imf::InputFile file(path.c_str());
  std::vector<std::string> names;
  const Imf::ChannelList& channels = file.header().channels();
  for (auto channel = channels.begin(); channel != channels.end(); ++channel)
    names.emplace_back(channel.name());
  return names;
}

/// Writes one channel through OpenEXR itself.
void write_foreign(const std::filesystem::path& path, const std::string& name,
                   const Imath::Box2i& window, const std::vector<half>& values, int sampling = 1) {
  Imf::Header header(Imath::Box2i({0, 0}, {99, 99}), window);
  header.channels().insert(name, Imf::Channel(Imf::HALF, sampling, sampling));
  Imf::FrameBuffer buffer;
  const auto width = static_cast<size_t>(window.max.x - window.min.x + 1);
  buffer.insert(name, Imf::Slice::Make(Imf::HALF, values.data(), window, sizeof(half),
                                       width * sizeof(half), sampling, sampling));
  Imf::OutputFile file(path.c_str(), header);
  file.setFrameBuffer(buffer);
  file.writePixels(window.max.y - window.min.y + 1);
}

TEST(Exr, RoundTripsEveryBit) {
  const TempDir dir;
  Image picture = random_image(33, 17, 3, 1, -1e6f, 1e6f);
  picture.pixels[0] = INFINITY;
  picture.pixels[1] = 1e-42f;
  picture.pixels[2] = NAN;
  write_exr(dir / "a.exr", {{"", &picture}});
  const Image again = read_exr(dir / "a.exr");
  ASSERT_EQ(again.width, 33);
  ASSERT_EQ(again.height, 17);
  ASSERT_EQ(again.channels, 3);
  EXPECT_EQ(std::memcmp(again.pixels.data(), picture.pixels.data(),
                        picture.pixels.size() * sizeof(float)),
            0);
  EXPECT_EQ(dir.count(), 1u);
}

TEST(Exr, LayersHaveTheChannelsOfTheContract) {
  const TempDir dir;
  const Image color = random_image(5, 4, 3, 1), albedo = random_image(5, 4, 3, 2),
              normal = random_image(5, 4, 3, 3);
  const Image position = random_image(5, 4, 3, 4), depth = random_image(5, 4, 1, 5),
              spp = random_image(5, 4, 1, 6);
  write_exr(dir / "a.exr", {{"", &color},
                            {"albedo", &albedo},
                            {"normal", &normal},
                            {"position", &position},
                            {"depth", &depth},
                            {"spp", &spp}});
  EXPECT_THAT(channels_of(dir / "a.exr"),
              testing::UnorderedElementsAre("R", "G", "B", "albedo.R", "albedo.G", "albedo.B",
                                            "normal.X", "normal.Y", "normal.Z", "position.X",
                                            "position.Y", "position.Z", "depth.Z", "spp.Y"));
  EXPECT_EQ(read_exr(dir / "a.exr").pixels, color.pixels);
  EXPECT_EQ(read_exr(dir / "a.exr", "albedo").pixels, albedo.pixels);
  EXPECT_EQ(read_exr(dir / "a.exr", "normal").pixels, normal.pixels);
  EXPECT_EQ(read_exr(dir / "a.exr", "position").pixels, position.pixels);
  EXPECT_EQ(read_exr(dir / "a.exr", "depth").pixels, depth.pixels);
  EXPECT_EQ(read_exr(dir / "a.exr", "spp").pixels, spp.pixels);
  EXPECT_EQ(read_exr(dir / "a.exr", "depth").channels, 1);
}

TEST(Exr, TextsStandInTheHeader) {
  const TempDir dir;
  const Image picture = random_image(3, 2, 3, 1, 0, 1);
  write_exr(dir / "a.exr", {{"", &picture}}, {{"lteCamera", "{\"vfov\": 40}"}});
  const Imf::InputFile file((dir / "a.exr").c_str());
  const auto* text = file.header().findTypedAttribute<Imf::StringAttribute>("lteCamera");
  ASSERT_NE(text, nullptr);
  EXPECT_EQ(text->value(), "{\"vfov\": 40}");
  EXPECT_EQ(read_exr_text(dir / "a.exr", "lteCamera"), text->value());
  EXPECT_EQ(read_exr_text(dir / "a.exr", "other"), std::nullopt);
  EXPECT_EQ(read_exr_text(dir / "a.exr", "compression"), std::nullopt) << "no text";
  write_file(dir / "b.exr", "no picture");
  EXPECT_THAT(error_of([&] { read_exr_text(dir / "b.exr", "x"); }), HasSubstr("b.exr"));
}

TEST(Exr, ReadsPicturesTallerThanAStrip) {
  const TempDir dir;
  for (const int height : {255, 256, 257, 700}) {
    const Image picture = random_image(3, height, 3, 1);
    write_exr(dir / "a.exr", {{"", &picture}});
    EXPECT_EQ(read_exr(dir / "a.exr").pixels, picture.pixels) << height;
  }
}

TEST(Exr, OneChannelWithoutNameIsLuminance) {
  const TempDir dir;
  const Image gray = random_image(3, 2, 1, 1);
  write_exr(dir / "a.exr", {{"", &gray}});
  EXPECT_THAT(channels_of(dir / "a.exr"), testing::ElementsAre("Y"));
  EXPECT_EQ(read_exr(dir / "a.exr").pixels, gray.pixels);
}

TEST(Exr, RowZeroIsTheTop) {
  const TempDir dir;
  Image picture(2, 2, 1);
  picture.pixels = {1, 2, 3, 4};
  write_exr(dir / "a.exr", {{"", &picture}});
  float top[2] = {};
  Imf::InputFile file((dir / "a.exr").c_str());
  Imf::FrameBuffer buffer;
  buffer.insert("Y", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(top), sizeof(float), 0));
  file.setFrameBuffer(buffer);
  file.readPixels(0, 0);
  EXPECT_EQ(top[0], 1);
  EXPECT_EQ(top[1], 2);
}

TEST(Exr, ReadsHalfPixelsOfAnOffsetWindow) {
  const TempDir dir;
  write_foreign(dir / "a.exr", "Y", Imath::Box2i({-7, 20}, {-6, 22}),
                {half(1), half(2), half(3), half(4), half(0.5f), half(6)});
  const Image picture = read_exr(dir / "a.exr");
  EXPECT_EQ(picture.width, 2);
  EXPECT_EQ(picture.height, 3);
  EXPECT_EQ(picture.pixels, (std::vector<float>{1, 2, 3, 4, 0.5f, 6}));
}

TEST(Exr, SameContentGivesTheSameBytes) {
  const TempDir dir;
  const Image picture = random_image(20, 20, 3, 1);
  write_exr(dir / "a.exr", {{"", &picture}});
  write_exr(dir / "b.exr", {{"", &picture}});
  EXPECT_EQ(read_file(dir / "a.exr"), read_file(dir / "b.exr"));
}

TEST(Exr, MissingLayerListsThoseThere) {
  const TempDir dir;
  const Image color(4, 4, 3), depth(4, 4, 1);
  write_exr(dir / "a.exr", {{"", &color}, {"depth", &depth}});
  EXPECT_THAT(
      error_of([&] { read_exr(dir / "a.exr", "albedo"); }),
      AllOf(HasSubstr("a.exr"), HasSubstr("has no layer \"albedo\"; it has: (unnamed), depth")));
  write_foreign(dir / "b.exr", "odd", Imath::Box2i({0, 0}, {0, 0}), {half(1)});
  EXPECT_THAT(error_of([&] { read_exr(dir / "b.exr"); }), HasSubstr("none that can be read"));
}

TEST(Exr, RefusesSubsampledChannels) {
  const TempDir dir;
  write_foreign(dir / "a.exr", "Y", Imath::Box2i({0, 0}, {3, 3}), std::vector<half>(16), 2);
  EXPECT_THAT(error_of([&] { read_exr(dir / "a.exr"); }), HasSubstr("subsampled"));
}

TEST(Exr, RefusesWhatItCannotWrite) {
  const TempDir dir;
  const Image a(4, 4, 3), b(4, 5, 3), c(4, 4, 2), none;
  const auto error = [&](const std::vector<Layer>& layers) {
    return error_of([&] { write_exr(dir / "a.exr", layers); });
  };
  EXPECT_THAT(error({}), HasSubstr("no layers"));
  EXPECT_THAT(error({{"", &a}, {"x", &b}}),
              HasSubstr("layer \"x\" is 4 x 5, the first layer 4 x 4"));
  EXPECT_THAT(error({{"", &c}}), HasSubstr("1 or 3 channels, got 2"));
  EXPECT_THAT(error({{"", &a}, {"", &a}}), HasSubstr("given twice"));
  EXPECT_THAT(error({{"", nullptr}}), HasSubstr("has no image"));
  EXPECT_THAT(error({{"", &none}}), HasSubstr("got 0"));
  EXPECT_THAT(error_of([&] { write_exr(dir / "no/a.exr", {{"", &a}}); }), HasSubstr("no/a.exr"));
  EXPECT_EQ(dir.count(), 0u);
}

TEST(Exr, RefusesWhatIsNoExr) {
  const TempDir dir;
  write_file(dir / "text.exr", "this is no picture, and long enough to hold a header");
  write_file(dir / "empty.exr", "");
  for (const char* name : {"text.exr", "empty.exr"}) {
    EXPECT_THAT(error_of([&] { read_exr(dir / name); }),
                AllOf(HasSubstr(name), HasSubstr("cannot read as OpenEXR")));
  }
  EXPECT_THAT(error_of([&] { read_exr(dir / "none.exr"); }), HasSubstr("No such file"));
}

/// A file whose header declares another data window than the pixels that follow.
std::string with_window(std::string bytes, int32_t max_x, int32_t max_y) {
  for (const char* attribute : {"dataWindow", "displayWindow"}) {
    const size_t place =
        bytes.find(attribute) + std::strlen(attribute) + 1 + std::strlen("box2i") + 1 + 4;
    const int32_t window[4] = {0, 0, max_x, max_y};
    std::memcpy(bytes.data() + place, window, sizeof(window));
  }
  return bytes;
}

TEST(Exr, RefusesHostileSizes) {
  const TempDir dir;
  const Image picture = random_image(8, 8, 3, 1);
  write_exr(dir / "good.exr", {{"", &picture}});
  const std::string good = read_file(dir / "good.exr");
  ASSERT_EQ(with_window(good, 7, 7), good);
  const std::pair<int32_t, int32_t> sizes[] = {
      {INT32_MAX - 1, INT32_MAX - 1}, {INT32_MAX, 7}, {7, INT32_MAX},        {1 << 21, 0},
      {(1 << 15) - 1, (1 << 14) - 1}, {-2, 7},        {INT32_MIN, INT32_MIN}};
  for (const auto& [x, y] : sizes) {
    write_file(dir / "bad.exr", with_window(good, x, y));
    EXPECT_THAT(error_of([&] { read_exr(dir / "bad.exr"); }), HasSubstr("bad.exr"))
        << x << ", " << y;
  }
  // Within the limits, but hardly any pixels follow.
  write_file(dir / "bad.exr", with_window(good, (1 << 14) - 1, (1 << 14) - 1));
  EXPECT_THAT(error_of([&] { read_exr(dir / "bad.exr"); }), HasSubstr("bad.exr"));
  EXPECT_LT(peak_rss_mb(), 1000) << "refused before anything was allocated";
}

TEST(Exr, EveryTruncationIsRefused) {
  const TempDir dir;
  const Image picture = random_image(6, 40, 3, 1);
  write_exr(dir / "good.exr", {{"", &picture}});
  const std::string good = read_file(dir / "good.exr");
  for (size_t size = 0; size < good.size(); size += 7) {
    test::write_text(dir / "cut.exr", good.substr(0, size));
    EXPECT_THAT(error_of([&] { read_exr(dir / "cut.exr"); }), HasSubstr("cut.exr")) << size;
  }
}

}  // namespace
}  // namespace lte::image
