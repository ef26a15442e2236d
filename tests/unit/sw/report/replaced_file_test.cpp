#include "sw/report/replaced_file.h"

#include <gtest/gtest.h>

#include <csignal>
#include <iterator>
#include <system_error>
#include <vector>

#include "sw/report/whole_file.h"
#include "tests/support/file_size_limit.h"
#include "tests/support/fork.h"
#include "tests/support/scratch_folder.h"

namespace stereotlm::report {
namespace {

namespace fs = std::filesystem;

class ReplacedFileTest : public ::testing::Test {
 protected:
  std::ptrdiff_t files() const { return std::distance(fs::directory_iterator(scratch_.path()), {}); }

  test::ScratchFolder scratch_;
  fs::path path_ = scratch_.path() / "file";
};

TEST_F(ReplacedFileTest, IsThereWholeAfterTheCommit) {
  test::write_file(path_, "old");
  ReplacedFile file(path_);
  file.write("one, ");
  file.write("two");
  EXPECT_EQ(test::read_file(path_), "old");
  file.commit();
  EXPECT_EQ(test::read_file(path_), "one, two");
  EXPECT_EQ(files(), 1);
}

TEST_F(ReplacedFileTest, IsAsItWasWithoutACommit) {
  { ReplacedFile(path_).write("new"); }
  EXPECT_EQ(files(), 0);
  test::write_file(path_, "old");
  { ReplacedFile(path_).write("new"); }
  EXPECT_EQ(test::read_file(path_), "old");
  EXPECT_EQ(files(), 1);
}

TEST_F(ReplacedFileTest, LeavesAllOtherFilesAlone) {
  for (const char* name : {"file.part", ".file.writing-", ".file.writing-0123456789abcdeg",
                           ".file.writing-0123456789abcdef0", ".other.writing-0123456789abcdef"})
    test::write_file(scratch_.path() / name, "precious");
  fs::create_directory(scratch_.path() / ".file.writing-0123456789abcdef");
  fs::create_symlink("file.part", scratch_.path() / ".file.writing-0123456789abcde0");
  remove_left_aside(path_);
  replace_file(path_, "new");
  { ReplacedFile(path_).write("newer"); }
  EXPECT_EQ(test::read_file(path_), "new");
  EXPECT_EQ(test::read_file(scratch_.path() / "file.part"), "precious");
  EXPECT_EQ(files(), 8);
}

TEST_F(ReplacedFileTest, WhatAKilledProcessHasLeftAsideGoes) {
  const auto killed = test::run_in_child([this] {
    ReplacedFile file(path_);
    file.write("half");
    raise(SIGKILL);
    return "";
  });
  EXPECT_EQ(killed.exit_status, 128 + SIGKILL);
  EXPECT_EQ(files(), 1);
  ReplacedFile living(path_);
  EXPECT_EQ(files(), 2);
  remove_left_aside(path_);
  EXPECT_EQ(files(), 1);
  living.write("whole");
  living.commit();
  EXPECT_EQ(test::read_file(path_), "whole");
  EXPECT_EQ(files(), 1);
}

TEST_F(ReplacedFileTest, TakesTheLongestName) {
  const fs::path longest = scratch_.path() / std::string(255, 'n');
  replace_file(longest, "new");
  EXPECT_EQ(test::read_file(longest), "new");
}

TEST_F(ReplacedFileTest, TwoAtOnceDoNotMeet) {
  ReplacedFile first(path_);
  ReplacedFile second(path_);
  first.write("first");
  second.write("second");
  second.commit();
  EXPECT_EQ(test::read_file(path_), "second");
  first.commit();
  EXPECT_EQ(test::read_file(path_), "first");
}

TEST_F(ReplacedFileTest, LeavesNothingBehindWhereItFails) {
  EXPECT_THROW(ReplacedFile(scratch_.path() / "none" / "file"), std::system_error);
  {
    const test::FileSizeLimit limit(10);
    EXPECT_THROW(replace_file(path_, "more than ten"), std::system_error);
  }
  EXPECT_EQ(files(), 0);
  fs::create_directory(path_);
  EXPECT_THROW(replace_file(path_, "no file can take its name"), std::system_error);
  EXPECT_EQ(files(), 1);
}

}  // namespace
}  // namespace stereotlm::report
