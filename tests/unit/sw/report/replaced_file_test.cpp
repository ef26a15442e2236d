#include "sw/report/replaced_file.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <iterator>
#include <system_error>
#include <vector>

#include "sw/report/whole_file.h"
#include "tests/support/file_size_limit.h"
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
  const auto taken = [this](int number) {
    return scratch_.path() / fmt::format(".stereotlm_{}_{}", getpid(), number);
  };
  const std::vector<fs::path> others = {path_.string() + ".part", taken(0), taken(1)};
  for (const fs::path& other : others) test::write_file(other, "precious");
  replace_file(path_, "new");
  { ReplacedFile(path_).write("newer"); }
  EXPECT_EQ(test::read_file(path_), "new");
  for (const fs::path& other : others) EXPECT_EQ(test::read_file(other), "precious");
  EXPECT_EQ(files(), 4);
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
