#include "infer/render/picture_writer.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/image/png.h"
#include "tests/infer/fixture.h"

namespace lte::infer {
namespace {

FinishedPicture gray(const std::filesystem::path& out, float value) {
  FinishedPicture picture;
  picture.out = out;
  picture.frame.color = image::Image(8, 4, 3);
  for (float& pixel : picture.frame.color.pixels) pixel = value;
  return picture;
}

TEST(PictureWriter, WritesPicturesInTheirOrderAndSaysSo) {
  const test::TempDir folder;
  std::vector<std::string> written;
  PictureWriter writer([&](const FinishedPicture& picture) {
    EXPECT_TRUE(std::filesystem::exists(picture.out)) << "told once the file is there";
    written.push_back(picture.out.filename());
  });
  for (const char* name : {"0.png", "1.png", "2.png"})
    writer.write(gray(folder / name, name[0] == '1' ? 1.0f : 0.0f));
  writer.finish();
  EXPECT_EQ(written, (std::vector<std::string>{"0.png", "1.png", "2.png"}));
  EXPECT_EQ(image::read_png(folder / "1.png").rgb(3, 2).x, 1);
  EXPECT_EQ(image::read_png(folder / "2.png").rgb(3, 2).x, 0);
  EXPECT_GT(writer.seconds(), 0);
}

TEST(PictureWriter, SaysWhatCouldNotBeWrittenWithTheNextPictureOrAtTheEnd) {
  const test::TempDir folder;
  const auto never = [](const FinishedPicture& picture) { ADD_FAILURE() << picture.out; };
  PictureWriter writer(never);
  writer.write(gray(folder / "none" / "0.png", 1));
  EXPECT_THROW(writer.write(gray(folder / "1.png", 1)), Error);
  PictureWriter last(never);
  last.write(gray(folder / "none" / "2.png", 1));
  EXPECT_THROW(last.finish(), Error);
}

}  // namespace
}  // namespace lte::infer
