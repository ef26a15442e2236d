#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "sw/runs/run_results.h"
#include "tests/support/file_size_limit.h"
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

struct ResultFolder : files::OutputFolder {
  explicit ResultFolder(const fs::path& dir) : OutputFolder(dir, result_content()) {}
};

std::string refusal(const fs::path& dir) {
  return test::message_of([&] { const ResultFolder folder(dir); });
}

// A result of run.json alone.
void write(const fs::path& dir) {
  ResultFolder folder(dir);
  folder.add("run.json", "new");
  folder.commit();
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

TEST_F(ResultFolderTest, AcceptsATrailingSlashAndALinkToAnEmptyFolder) {
  write(out_ / "");
  EXPECT_THAT(names_in(out_), ElementsAre("run.json"));
  fs::remove(out_ / "run.json");
  fs::create_directory_symlink(out_, scratch_.path() / "link");
  write(scratch_.path() / "link");
  EXPECT_THAT(names_in(out_), ElementsAre("run.json"));
}

TEST_F(ResultFolderTest, ReplacesEveryFileThatARunWritesAtTheCommit) {
  for (const char* name :
       {"disparity.png", "disparity.pfm", "disparity_color.png", "depth.ply", "depth.png", "depth_color.png",
        "stats.json", "config.yaml", "run.json", "timeline.csv", "latency.csv", "rows.csv", "conflicts.csv",
        "frames/000000.png", "frames/1234567.png"}) {
    test::write_file(out_ / name, "old");
  }
  ResultFolder folder(out_);
  folder.add("run.json", "new");
  folder.add("stats.json", "new");
  EXPECT_EQ(test::read_file(out_ / "run.json"), "old");
  EXPECT_EQ(test::read_file(out_ / "stats.json"), "old");
  folder.commit();
  EXPECT_THAT(names_in(out_), ElementsAre("run.json", "stats.json"));
  EXPECT_EQ(test::read_file(out_ / "run.json"), "new");
}

TEST_F(ResultFolderTest, RefusesAFolderWithAnotherFileOrWithoutRunJson) {
  test::write_file(out_ / "stats.json", "old");
  EXPECT_THAT(refusal(out_), HasSubstr("holds 'stats.json' but no run.json"));
  test::write_file(out_ / "run.json", "old");
  test::write_file(out_ / "thesis.tex", "precious");
  EXPECT_EQ(refusal(out_),
            "result folder '" + out_.string() +
                "': holds 'thesis.tex': must be empty or hold run.json and only files that run writes");
  EXPECT_THAT(names_in(out_), ElementsAre("run.json", "stats.json", "thesis.tex"));
}

TEST_F(ResultFolderTest, RefusesEntriesThatOnlyLookLikeAResult) {
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

TEST_F(ResultFolderTest, RemovesTheFilesOfAKilledRun) {
  test::write_file(out_ / ".partial/new/frames/000000.png", "half");
  test::write_file(out_ / ".partial/probe", "");
  test::write_file(out_ / "run.json", "old");
  test::write_file(out_ / "stats.json", "old");
  ResultFolder folder(out_);
  EXPECT_THAT(names_in(out_), ElementsAre(".partial", ".partial/new", "run.json", "stats.json"));
  folder.add("run.json", "new");
  folder.commit();
  EXPECT_THAT(names_in(out_), ElementsAre("run.json"));
}

TEST_F(ResultFolderTest, LeavesEverythingAsItWasWithoutACommit) {
  const auto begin = [](const fs::path& dir) {
    ResultFolder folder(dir);
    folder.add("run.json", "new");
    folder.add("frames/000000.png", "new");
  };
  begin(out_ / "a");
  EXPECT_THAT(names_in(scratch_.path()), IsEmpty()) << "not even the folders it created";
  fs::create_directory(out_);
  begin(out_);
  EXPECT_THAT(names_in(scratch_.path()), ElementsAre("out")) << "a folder that was there stays";
  test::write_file(out_ / "run.json", "old");
  begin(out_);
  EXPECT_THAT(names_in(out_), ElementsAre("run.json"));
  EXPECT_EQ(test::read_file(out_ / "run.json"), "old");
}

TEST_F(ResultFolderTest, KeepsACreatedFolderThatGotAnotherFileWithoutACommit) {
  {
    const ResultFolder folder(out_ / "a");
    test::write_file(out_ / "note", "x");
  }
  EXPECT_THAT(names_in(out_), ElementsAre("note"));
}

TEST_F(ResultFolderTest, RefusesASecondRunIntoTheFolder) {
  {
    const ResultFolder first(out_);
    EXPECT_THAT(refusal(out_), HasSubstr("in use by another run"));
    EXPECT_TRUE(fs::exists(out_ / ".partial")) << "the first one's files stay";
  }
  EXPECT_NO_THROW(ResultFolder{out_});
}

TEST_F(ResultFolderTest, KeepsFilesThatAppearDuringTheRun) {
  test::write_file(out_ / "run.json", "old");
  ResultFolder folder(out_);
  folder.add("run.json", "new");
  test::write_file(out_ / "note", "precious");
  folder.commit();
  EXPECT_THAT(names_in(out_), ElementsAre("note", "run.json"));
}

TEST_F(ResultFolderTest, RefusesToReplaceAFrameFolderThatGotAnotherFile) {
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

TEST_F(ResultFolderTest, AcceptsOnlyFilesThatARunWritesAndEachOnce) {
  ResultFolder folder(out_);
  folder.add("stats.json", "x");
  for (const char* name : {"stats.json", "", "notes.txt", "../run.json", "frames/0.png",
                           "frames/../000000.png", "frames", ".partial/run.json", "000000.png"}) {
    EXPECT_THROW(folder.add(name, "x"), std::invalid_argument) << name;
  }
}

TEST_F(ResultFolderTest, AppendsToAFileUntilTheCommit) {
  ResultFolder folder(out_);
  folder.append("timeline.csv", "a\n");
  folder.append("latency.csv", "");
  folder.append("timeline.csv", "b\n");
  EXPECT_THROW(folder.add("timeline.csv", "x"), std::invalid_argument);
  folder.add("run.json", "x");
  EXPECT_THROW(folder.append("run.json", "x"), std::invalid_argument);
  EXPECT_THROW(folder.append("notes.txt", "x"), std::invalid_argument);
  folder.commit();
  EXPECT_THAT(names_in(out_), ElementsAre("latency.csv", "run.json", "timeline.csv"));
  EXPECT_EQ(test::read_file(out_ / "timeline.csv"), "a\nb\n");
  EXPECT_EQ(test::read_file(out_ / "latency.csv"), "");
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

TEST_F(ResultFolderTest, RefusesAPathThatCannotBeAFolder) {
  const std::string file = test::write_file(scratch_.path() / "file", "x");
  EXPECT_EQ(refusal(file), "result folder '" + file + "': not a folder");
  EXPECT_EQ(refusal(file + "/out"),
            "result folder '" + file + "/out': cannot be written to: Not a directory");
  fs::create_symlink("nowhere", scratch_.path() / "dangling");
  EXPECT_THAT(refusal(scratch_.path() / "dangling"), HasSubstr("not a folder"));
  EXPECT_THAT(refusal(""), HasSubstr("must be named"));
  EXPECT_THAT(refusal("/proc/stereotlm/out"),
              HasSubstr("result folder '/proc/stereotlm/out': cannot be written to: "));
}

TEST_F(ResultFolderTest, RefusesAFolderThatTakesNoBytes) {
  {
    const test::FileSizeLimit limit(0);
    EXPECT_THAT(refusal(scratch_.path() / "out"), HasSubstr("cannot be written to: File too large"));
  }
  EXPECT_TRUE(fs::is_empty(scratch_.path())) << "it changed nothing";
}

TEST_F(ResultFolderTest, AFileThatDoesNotFitLeavesTheEarlierResultIntact) {
  test::write_file(scratch_.path() / "run.json", "old");
  {
    const test::FileSizeLimit limit(1000);
    ResultFolder folder(scratch_.path());
    folder.add("run.json", std::string(1000, 'x'));
    EXPECT_EQ(
        test::message_of([&] { folder.add("stats.json", std::string(1001, 'x')); }),
        "result folder '" + scratch_.path().string() + "': 'stats.json' cannot be written: File too large");
  }
  EXPECT_EQ(test::read_file(scratch_.path() / "run.json"), "old");
  EXPECT_EQ(std::distance(fs::directory_iterator(scratch_.path()), {}), 1);
}

}  // namespace
}  // namespace stereotlm::runs
