#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>
#include <unistd.h>

#include <fstream>
#include <iterator>
#include <stdexcept>

#include "sw/runs/result_folder.h"
#include "tests/support/file_size_limit.h"
#include "tests/support/fork.h"
#include "tests/support/scratch_folder.h"

// What happens when the file system refuses.
namespace stereotlm::runs {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

std::string refusal(const fs::path& dir) {
  return test::message_of([&] { const ResultFolder folder(dir); });
}

TEST(ResultFolderFailure, RefusesAFileAndWhatLiesBelowOne) {
  const test::ScratchFolder scratch;
  const std::string file = test::write_file(scratch.path() / "file", "x");
  EXPECT_EQ(refusal(file), "result folder '" + file + "': not a folder");
  EXPECT_EQ(refusal(file + "/out"),
            "result folder '" + file + "/out': cannot be written to: Not a directory");
  fs::create_symlink("nowhere", scratch.path() / "dangling");
  EXPECT_THAT(refusal(scratch.path() / "dangling"), HasSubstr("not a folder"));
  EXPECT_THAT(refusal(""), HasSubstr("must be named"));
}

TEST(ResultFolderFailure, RefusesAFileSystemThatTakesNoFolders) {
  EXPECT_THAT(refusal("/proc/stereotlm/out"),
              HasSubstr("result folder '/proc/stereotlm/out': cannot be written to: "));
}

TEST(ResultFolderFailure, RefusesAFolderWithoutPermission) {
  if (geteuid() == 0) GTEST_SKIP() << "permissions do not bind root";
  const test::ScratchFolder scratch;
  fs::permissions(scratch.path(), fs::perms::owner_read | fs::perms::owner_exec);
  EXPECT_THAT(refusal(scratch.path()), HasSubstr("cannot be written to: Permission denied"));
  EXPECT_THAT(refusal(scratch.path() / "out"), HasSubstr("cannot be written to: Permission denied"));
  fs::permissions(scratch.path(), fs::perms::owner_all);
}

TEST(ResultFolderFailure, RefusesAFolderThatTakesNoBytes) {
  const test::ScratchFolder scratch;
  {
    const test::FileSizeLimit limit(0);
    EXPECT_THAT(refusal(scratch.path() / "out"), HasSubstr("cannot be written to: File too large"));
  }
  EXPECT_TRUE(fs::is_empty(scratch.path())) << "it changed nothing";
}

TEST(ResultFolderFailure, AFileThatDoesNotFitLeavesTheEarlierResultIntact) {
  const test::ScratchFolder scratch;
  test::write_file(scratch.path() / "run.json", "old");
  {
    const test::FileSizeLimit limit(1000);
    ResultFolder folder(scratch.path());
    folder.add("run.json", std::string(1000, 'x'));
    EXPECT_EQ(
        test::message_of([&] { folder.add("stats.json", std::string(1001, 'x')); }),
        "result folder '" + scratch.path().string() + "': 'stats.json' cannot be written: File too large");
    EXPECT_FALSE(fs::exists(scratch.path() / ".partial/new/stats.json"));
  }
  EXPECT_EQ(test::read_file(scratch.path() / "run.json"), "old");
  EXPECT_EQ(std::distance(fs::directory_iterator(scratch.path()), {}), 1);
}

TEST(ResultFolderFailure, ACommitThatFailsPutsTheEarlierResultBack) {
  const test::ScratchFolder scratch;
  test::write_file(scratch.path() / "config.yaml", "old");
  test::write_file(scratch.path() / "run.json", "old");
  {
    ResultFolder folder(scratch.path());
    folder.add("config.yaml", "new");
    folder.add("run.json", "new");
    folder.add("stats.json", "new");
    fs::create_directory(scratch.path() / "stats.json");  // no file can take the name of a folder
    EXPECT_THAT(test::message_of([&] { folder.commit(); }),
                HasSubstr("the new files cannot be moved into place: Is a directory"));
  }
  EXPECT_EQ(test::read_file(scratch.path() / "config.yaml"), "old");
  EXPECT_EQ(test::read_file(scratch.path() / "run.json"), "old");
  EXPECT_TRUE(fs::is_directory(scratch.path() / "stats.json"));
  EXPECT_FALSE(fs::exists(scratch.path() / ".partial"));
}

constexpr const char* kNoSmallDisk = "no small disk can be mounted here";

// Lets this process mount without disturbing anyone: as root, or as the root of a user namespace of its own.
bool may_mount() {
  const std::string user = "0 " + std::to_string(geteuid()) + " 1";
  const std::string group = "0 " + std::to_string(getegid()) + " 1";
  if (unshare(CLONE_NEWNS) == 0) return true;
  if (unshare(CLONE_NEWUSER | CLONE_NEWNS) != 0) return false;
  const auto set = [](const char* path, const std::string& text) {
    return static_cast<bool>((std::ofstream(path) << text).flush());
  };
  return set("/proc/self/setgroups", "deny") && set("/proc/self/uid_map", user) &&
         set("/proc/self/gid_map", group);
}

// For a child process: mounts the disk in a namespace of its own.
std::string fill_a_small_disk(const fs::path& disk) {
  if (!may_mount()) return kNoSmallDisk;
  mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr);
  if (mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=64k") != 0) return kNoSmallDisk;

  test::write_file(disk / "run.json", "old");
  {
    ResultFolder folder(disk);
    folder.add("run.json", "new");
    EXPECT_EQ(
        test::message_of([&] { folder.add("disparity.png", std::string(100'000, 'x')); }),
        "result folder '" + disk.string() + "': 'disparity.png' cannot be written: No space left on device");
  }
  EXPECT_EQ(test::read_file(disk / "run.json"), "old");
  EXPECT_EQ(std::distance(fs::directory_iterator(disk), {}), 1);

  // A disk that is full from the start is known before the run.
  std::ofstream filler(disk / "filler", std::ios::binary);
  while (filler.write("x", 1).flush()) {
  }
  fs::rename(disk / "filler", disk / "stats.json");
  EXPECT_THAT(refusal(disk), HasSubstr("cannot be written to: No space left on device"));
  EXPECT_EQ(test::read_file(disk / "run.json"), "old");
  return "";
}

TEST(ResultFolderFailure, AFullDiskLeavesTheEarlierResultIntact) {
  const test::ScratchFolder scratch;
  const test::ChildResult result = test::run_in_child([&] { return fill_a_small_disk(scratch.path()); });
  if (result.text == kNoSmallDisk) GTEST_SKIP() << kNoSmallDisk;
  EXPECT_TRUE(result.ok()) << result.text;
}

}  // namespace
}  // namespace stereotlm::runs
