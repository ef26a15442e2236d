#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

#include "platform/config/board_yaml.h"
#include "sw/media/encode.h"
#include "sw/media/synthetic_scene.h"
#include "sw/runs/sources/open_source.h"
#include "tests/support/scratch_folder.h"

namespace stereotlm::runs {
namespace {

using kernels::GrayImage;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Pair i is of grey level i. Counts what is loaded.
struct Levels : PairSource {
  explicit Levels(std::uint64_t length)
      : PairSource("--levels", length, [this](std::uint64_t index) {
          if (is_broken) throw std::runtime_error("'x': broken");
          loaded.push_back(index);
          const GrayImage image(4, 1, static_cast<std::uint8_t>(index));
          return host::StereoPair{image, image};
        }) {}
  std::vector<std::uint64_t> loaded;
  bool is_broken = false;
};

int level(PairSource& pairs, std::uint64_t frame) { return pairs.pair(frame).right.at(0, 0); }

TEST(PairSource, RepeatsFromTheFirstPairAfterTheLast) {
  Levels pairs(7);
  for (std::uint64_t frame = 0; frame < 30; ++frame)
    EXPECT_EQ(level(pairs, frame), static_cast<int>(frame % 7));
  EXPECT_EQ(level(pairs, PairSource::kEndless), static_cast<int>(PairSource::kEndless % 7));
}

TEST(PairSource, LoadsAPairOnceWhileItIsHeld) {
  Levels few(4);
  for (std::uint64_t frame = 0; frame < 100; ++frame) few.pair(frame);
  EXPECT_THAT(few.loaded, ElementsAre(0, 1, 2, 3));
  Levels many(5);
  for (std::uint64_t frame = 0; frame < 10; ++frame) many.pair(frame);
  EXPECT_THAT(many.loaded, ElementsAre(0, 1, 2, 3, 4, 0, 1, 2, 3, 4));
}

TEST(PairSource, HoldsThePairsThatWereRequestedLast) {
  Levels pairs(10);
  for (const std::uint64_t frame : {0U, 1U, 2U, 3U, 0U, 4U, 5U, 6U}) pairs.pair(frame);
  const host::StereoPair& kept = pairs.pair(0);
  for (const std::uint64_t frame : {7U, 8U, 9U}) pairs.pair(frame);
  EXPECT_EQ(kept.left, GrayImage(4, 1, 0)) << "three others leave it where it is";
  EXPECT_EQ(&pairs.pair(0), &kept);
  EXPECT_THAT(pairs.loaded, ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8, 9));
}

TEST(PairSource, NamesItsOptionInAnErrorAndCanLoadAgain) {
  Levels pairs(10);
  pairs.pair(0);
  pairs.is_broken = true;
  EXPECT_EQ(test::message_of([&] { pairs.pair(1); }), "--levels 'x': broken");
  EXPECT_EQ(level(pairs, 0), 0);
  pairs.is_broken = false;
  EXPECT_EQ(level(pairs, 1), 1);
}

class OpenSourceTest : public ::testing::Test {
 protected:
  OpenedSource opened(const InputPictures& options) {
    process::Problems problems;
    described_ = options;
    OpenedSource source = open_source(described_, &board_, problems);
    problems.check();
    return source;
  }
  std::string picture(const std::string& name, int level, int width = 32) {
    const auto png = media::encode_png_gray(GrayImage(width, 24, static_cast<std::uint8_t>(level)));
    return test::write_file(folder_.path() / name, {reinterpret_cast<const char*>(png.data()), png.size()});
  }

  const platform::BoardConfig board_ =
      platform::load_board("fpl2003", {"image.width=32", "image.height=24", "matcher.disparities=8"});
  test::ScratchFolder folder_;
  InputPictures described_;
};

TEST_F(OpenSourceTest, OnePairIsReadOnce) {
  InputPictures options;
  options.left = {InputFile{picture("l.png", 1), ""}};
  options.right = {InputFile{picture("r.png", 2), ""}};
  const OpenedSource source = opened(options);
  std::filesystem::remove(options.left[0].path);
  EXPECT_EQ(source.pairs->length(), 1U);
  for (const std::uint64_t frame : {0U, 1U, 100U}) {
    EXPECT_EQ(source.pairs->pair(frame).left, GrayImage(32, 24, 1));
    EXPECT_EQ(source.pairs->pair(frame).right, GrayImage(32, 24, 2));
  }
}

TEST_F(OpenSourceTest, ASequenceFollowsItsNamesAndRefusesAPictureThatHasChanged) {
  for (const int number : {3, 0, 2, 1, 4, 5}) {
    picture("left_" + std::to_string(number) + ".png", number);
    picture("right_" + std::to_string(number) + ".png", 100 + number);
  }
  InputPictures options;
  options.sequence = InputFolder{folder_.path().string(), {}};
  const OpenedSource source = opened(options);
  EXPECT_EQ(source.pairs->length(), 6U);
  EXPECT_EQ(source.files.size(), 12U);
  EXPECT_EQ(described_.sequence->files.at(3).path, "right_1.png");
  for (std::uint64_t frame = 0; frame < 20; ++frame) {
    const int number = static_cast<int>(frame % 6);
    EXPECT_EQ(source.pairs->pair(frame).left.at(0, 0), number);
    EXPECT_EQ(source.pairs->pair(frame).right.at(0, 0), 100 + number);
  }
  const OpenedSource again = opened(options);
  const std::string changed = picture("right_1.png", 99);
  EXPECT_NO_THROW(again.pairs->pair(0));
  EXPECT_EQ(test::message_of([&] { again.pairs->pair(1); }),
            "--sequence '" + changed + "': changed: a picture must not change during a run");
  std::filesystem::remove(folder_.path() / "left_2.png");
  EXPECT_THAT(test::message_of([&] { again.pairs->pair(2); }),
              HasSubstr("left_2.png': cannot be read: No such"));
}

TEST_F(OpenSourceTest, ASyntheticSceneIsThatOfItsSeed) {
  InputPictures options;
  options.synthetic = 7;
  const OpenedSource source = opened(options);
  EXPECT_EQ(source.pairs->length(), PairSource::kEndless);
  EXPECT_EQ(described_.synthetic, 7U);
  const media::SyntheticScene scene(7, 32, 24, 8);
  for (const std::uint64_t frame : {0U, 1U, 1'000'000U}) {
    EXPECT_EQ(source.pairs->pair(frame).left, scene.frame(frame).left);
    EXPECT_EQ(source.pairs->pair(frame).right, scene.frame(frame).right);
    EXPECT_EQ(source.pairs->truth(frame)->levels, media::Truth(scene.frame(frame).disparity, 1).levels);
  }
}

TEST_F(OpenSourceTest, WithoutABoardSizesAreNotChecked) {
  InputPictures options;
  options.left = {InputFile{picture("l.png", 1, 16), ""}};
  options.right = {InputFile{picture("r.png", 2), ""}};
  process::Problems problems;
  open_source(options, nullptr, problems);
  EXPECT_TRUE(problems.empty());
  open_source(options, &board_, problems);
  EXPECT_FALSE(problems.empty());
}

}  // namespace
}  // namespace stereotlm::runs
