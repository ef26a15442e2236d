#include "sw/files/replaced_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <iterator>
#include <system_error>
#include <vector>

#include "sw/files/whole_file.h"
#include "tests/support/file_size_limit.h"
#include "tests/support/fork.h"
#include "tests/support/scratch_folder.h"

namespace stereotlm::files {
namespace {

namespace fs = std::filesystem;

class ReplacedFileTest : public ::testing::Test {
 protected:
  std::ptrdiff_t files() const { return std::distance(fs::directory_iterator(scratch_.path()), {}); }

  test::ScratchFolder scratch_;
  fs::path path_ = scratch_.path() / "file";
};

TEST_F(ReplacedFileTest, AppearsCompleteAtTheCommit) {
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

TEST_F(ReplacedFileTest, MayBeWrittenByItsPathAndCompletedBeforeTheCommit) {
  test::write_file(path_, "old");
  ReplacedFile file(path_);
  test::write_file(file.aside(), "new");
  file.complete();
  EXPECT_EQ(test::read_file(path_), "old");
  file.commit();
  EXPECT_EQ(test::read_file(path_), "new");
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

TEST_F(ReplacedFileTest, RemovesTheFileOfAKilledProcess) {
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

TEST_F(ReplacedFileTest, MayBeReplacedByTwoWritersAtOnce) {
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

TEST_F(ReplacedFileTest, ReplacesTheTargetOfALinkAndKeepsTheLink) {
  fs::create_directory(scratch_.path() / "real");
  const fs::path target = scratch_.path() / "real" / "target";
  fs::create_symlink("real/target", scratch_.path() / "second");
  fs::create_symlink(scratch_.path() / "second", path_);
  for (const char* const bytes : {"of a link to nothing", "of a link to a file"}) {
    replace_file(path_, bytes);
    EXPECT_EQ(test::read_file(target), bytes);
    EXPECT_TRUE(fs::is_symlink(path_) && fs::is_symlink(scratch_.path() / "second"));
    EXPECT_EQ(files(), 3);
  }
  fs::create_symlink("round", scratch_.path() / "round");
  EXPECT_THROW(replace_file(scratch_.path() / "round", ""), std::system_error);
}

TEST_F(ReplacedFileTest, KeepsItsModeAndItsOwner) {
  constexpr uid_t kOther = 4711;
  struct stat now = {};
  for (const mode_t mode : {0600U, 0664U, 0755U, 0440U}) {
    test::write_file(path_, "old");
    ASSERT_EQ(chmod(path_.c_str(), mode), 0);
    const bool is_given_away = chown(path_.c_str(), kOther, kOther) == 0;  // only root can
    replace_file(path_, "new");
    ASSERT_EQ(stat(path_.c_str(), &now), 0);
    EXPECT_EQ(now.st_mode & 07777U, mode);
    EXPECT_EQ(now.st_uid, is_given_away ? kOther : geteuid());
    EXPECT_EQ(now.st_gid, is_given_away ? kOther : getegid());
    fs::remove(path_);
  }
}

TEST_F(ReplacedFileTest, RefusesAFileThatIsNotRegular) {
  ASSERT_EQ(mkfifo(path_.c_str(), 0600), 0);
  EXPECT_THROW(ReplacedFile{path_}, std::system_error);
  EXPECT_TRUE(fs::is_fifo(path_));
  EXPECT_EQ(files(), 1);
}

}  // namespace
}  // namespace stereotlm::files
