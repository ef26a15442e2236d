#include "sw/runs/result_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "tests/support/scratch_folder.h"

namespace stereotlm::runs {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    names.push_back(entry.path().lexically_relative(folder).string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::string refusal(const fs::path& dir) {
  return test::message_of([&] { const ResultFolder folder(dir); });
}

class ResultFolderTest : public ::testing::Test {
 protected:
  test::ScratchFolder scratch_;
  fs::path out_ = scratch_.path() / "out";
};

TEST_F(ResultFolderTest, CreatesTheFolderAndItsParents) {
  const fs::path deep = out_ / "a" / "b";
  ResultFolder folder(deep);
  folder.add("run.json", "{}");
  folder.add("frames/000000.png", std::vector<std::uint8_t>{1, 0, 2});
  folder.commit();
  EXPECT_THAT(names_in(deep), ElementsAre("frames", "frames/000000.png", "run.json"));
  EXPECT_EQ(test::read_file(deep / "run.json"), "{}");
  EXPECT_EQ(test::read_file(deep / "frames/000000.png"), std::string("\x01\x00\x02", 3));
}

TEST_F(ResultFolderTest, AcceptsATrailingSlash) {
  {
    ResultFolder folder(out_ / "");
    folder.add("run.json", "{}");
    folder.commit();
  }
  EXPECT_THAT(names_in(out_), ElementsAre("run.json"));
}

TEST_F(ResultFolderTest, AcceptsAnEmptyFolderAndALinkToOne) {
  fs::create_directory(out_);
  fs::create_directory_symlink(out_, scratch_.path() / "link");
  ResultFolder folder(scratch_.path() / "link");
  folder.add("run.json", "{}");
  folder.commit();
  EXPECT_THAT(names_in(out_), ElementsAre("run.json"));
}

TEST_F(ResultFolderTest, ReplacesAnEarlierResultWhole) {
  test::write_file(out_ / "run.json", "old");
  test::write_file(out_ / "depth.ply", "old");
  test::write_file(out_ / "frames/000007.png", "old");
  ResultFolder folder(out_);
  folder.add("run.json", "new");
  folder.add("stats.json", "new");
  EXPECT_EQ(test::read_file(out_ / "run.json"), "old") << "nothing moves before the commit";
  EXPECT_FALSE(fs::exists(out_ / "stats.json"));
  folder.commit();
  EXPECT_THAT(names_in(out_), ElementsAre("run.json", "stats.json"));
  EXPECT_EQ(test::read_file(out_ / "run.json"), "new");
}

TEST_F(ResultFolderTest, ReplacesEveryFileThatARunWrites) {
  for (const char* name :
       {"disparity.png", "disparity.pfm", "disparity_color.png", "depth.ply", "depth.png", "stats.json",
        "config.yaml", "run.json", "frames/000000.png", "frames/1234567.png"}) {
    test::write_file(out_ / name, "old");
  }
  ResultFolder folder(out_);
  folder.add("run.json", "new");
  folder.commit();
  EXPECT_THAT(names_in(out_), ElementsAre("run.json"));
}

TEST_F(ResultFolderTest, RefusesAFolderWithAFileOfSomeoneElse) {
  test::write_file(out_ / "run.json", "old");
  test::write_file(out_ / "thesis.tex", "precious");
  EXPECT_EQ(refusal(out_),
            "result folder '" + out_.string() +
                "': holds 'thesis.tex': must be empty or hold run.json and only files that run writes");
  EXPECT_THAT(names_in(out_), ElementsAre("run.json", "thesis.tex"));
}

TEST_F(ResultFolderTest, RefusesAFolderWithoutRunJson) {
  test::write_file(out_ / "stats.json", "old");
  EXPECT_THAT(refusal(out_), HasSubstr("holds 'stats.json' but no run.json"));
}

TEST_F(ResultFolderTest, RefusesWhatOnlyLooksLikeAResult) {
  test::write_file(out_ / "run.json", "old");
  const auto holds = [this](const std::string& name) {
    const std::string message = refusal(out_);
    EXPECT_TRUE(fs::exists(fs::symlink_status(out_ / name))) << "a refused folder is left as it is";
    fs::remove_all(out_ / name);
    EXPECT_THAT(message, HasSubstr("holds '" + name + "'"));
  };
  fs::create_directory(out_ / "stats.json");
  holds("stats.json");
  fs::create_symlink("run.json", out_ / "config.yaml");
  holds("config.yaml");
  test::write_file(out_ / "frames", "a file");
  holds("frames");
  for (const char* name : {"frames/00000.png", "frames/000000.jpg", "frames/a00000.png", "frames/00000a.png",
                           "frames/000000.png.png", "frames/notes"}) {
    test::write_file(out_ / name, "x");
    holds(name);
  }
  fs::create_directory(out_ / "frames/000000.png");
  holds("frames/000000.png");
  test::write_file(out_ / ".partial", "a file");
  holds(".partial");
  test::write_file(out_ / ".partial/mine", "x");
  holds(".partial/mine");
  test::write_file(out_ / ".partial/new/mine", "x");
  holds(".partial/new/mine");
  test::write_file(out_ / ".partial/new/.partial/mine", "x");
  holds(".partial/new/.partial");
  fs::remove_all(out_ / ".partial");
  fs::remove_all(out_ / "frames");
  EXPECT_NO_THROW(ResultFolder{out_}) << "without them it is accepted";
}

TEST_F(ResultFolderTest, CleansWhatAKilledRunLeft) {
  test::write_file(out_ / ".partial/new/frames/000000.png", "half");
  test::write_file(out_ / ".partial/probe", "");
  test::write_file(out_ / "stats.json", "old");
  ResultFolder folder(out_);
  EXPECT_THAT(names_in(out_), ElementsAre(".partial", ".partial/new", "stats.json"));
  folder.add("run.json", "new");
  folder.commit();
  EXPECT_THAT(names_in(out_), ElementsAre("run.json"));
}

TEST_F(ResultFolderTest, WithoutCommitLeavesNothingBehind) {
  {
    ResultFolder folder(out_ / "a");
    folder.add("run.json", "new");
    folder.add("frames/000000.png", "new");
  }
  EXPECT_THAT(names_in(scratch_.path()), IsEmpty()) << "not even the folders it created";
  fs::create_directory(out_);
  { const ResultFolder folder(out_); }
  EXPECT_THAT(names_in(scratch_.path()), ElementsAre("out")) << "a folder that was there stays";
}

TEST_F(ResultFolderTest, WithoutCommitKeepsACreatedFolderThatSomeoneElseUses) {
  {
    const ResultFolder folder(out_ / "a");
    test::write_file(out_ / "note", "x");
  }
  EXPECT_THAT(names_in(out_), ElementsAre("note"));
}

TEST_F(ResultFolderTest, WithoutCommitKeepsTheEarlierResult) {
  test::write_file(out_ / "run.json", "old");
  {
    ResultFolder folder(out_);
    folder.add("run.json", "new");
  }
  EXPECT_THAT(names_in(out_), ElementsAre("run.json"));
  EXPECT_EQ(test::read_file(out_ / "run.json"), "old");
}

TEST_F(ResultFolderTest, RefusesASecondRunIntoTheFolder) {
  {
    const ResultFolder first(out_);
    EXPECT_THAT(refusal(out_), HasSubstr("in use by another run"));
    EXPECT_TRUE(fs::exists(out_ / ".partial")) << "the first one's files stay";
  }
  EXPECT_NO_THROW(ResultFolder{out_});
}

TEST_F(ResultFolderTest, KeepsFilesThatCameIntoTheFolderMeanwhile) {
  test::write_file(out_ / "run.json", "old");
  ResultFolder folder(out_);
  folder.add("run.json", "new");
  test::write_file(out_ / "note", "precious");
  folder.commit();
  EXPECT_THAT(names_in(out_), ElementsAre("note", "run.json"));
}

TEST_F(ResultFolderTest, RefusesToReplaceFramesAmongWhichAFileCameMeanwhile) {
  test::write_file(out_ / "run.json", "old");
  test::write_file(out_ / "frames/000000.png", "old");
  {
    ResultFolder folder(out_);
    folder.add("run.json", "new");
    test::write_file(out_ / "frames/note", "precious");
    EXPECT_THAT(test::message_of([&] { folder.commit(); }), HasSubstr("has been given 'frames/note'"));
  }
  EXPECT_THAT(names_in(out_), ElementsAre("frames", "frames/000000.png", "frames/note", "run.json"));
  EXPECT_EQ(test::read_file(out_ / "run.json"), "old");
}

TEST_F(ResultFolderTest, TakesOnlyFilesThatARunWritesAndEachOnce) {
  ResultFolder folder(out_);
  folder.add("stats.json", "x");
  for (const char* name : {"stats.json", "", "notes.txt", "../run.json", "frames/0.png",
                           "frames/../000000.png", "frames", ".partial/run.json", "000000.png"}) {
    EXPECT_THROW(folder.add(name, "x"), std::invalid_argument) << name;
  }
}

TEST_F(ResultFolderTest, NumbersFramesWithSixDigitsOrMore) {
  EXPECT_EQ(frame_file_name(0), "frames/000000.png");
  EXPECT_EQ(frame_file_name(999'999), "frames/999999.png");
  EXPECT_EQ(frame_file_name(1'000'000), "frames/1000000.png");
  ResultFolder folder(out_);
  folder.add(frame_file_name(999'999), "x");
  folder.add(frame_file_name(1'000'000), "x");
}

TEST_F(ResultFolderTest, CommitsOnceAndWithRunJson) {
  ResultFolder folder(out_);
  folder.add("stats.json", "x");
  EXPECT_THROW(folder.commit(), std::logic_error);
  folder.add("run.json", "x");
  folder.commit();
  EXPECT_THROW(folder.commit(), std::logic_error);
}

}  // namespace
}  // namespace stereotlm::runs
