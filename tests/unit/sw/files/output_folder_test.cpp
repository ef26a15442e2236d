#include "sw/files/output_folder.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>

#include "sw/files/folder_entries.h"
#include "tests/support/fork.h"
#include "tests/support/scratch_folder.h"

namespace {

int renames_left = -1;  // renames that succeed; below 0: all succeed
bool is_killed_there =
    false;  // the rename after them kills the process; otherwise it and all later ones fail

}  // namespace

// These replace the functions of the C library.
extern "C" int fsync(int /*file*/) { return 0; }  // the real one is slow
extern "C" int rename(const char* from, const char* to) noexcept {
  if (renames_left == 0 && is_killed_there) raise(SIGKILL);
  if (renames_left == 0) {
    errno = EIO;
    return -1;
  }
  if (renames_left > 0) --renames_left;
  return static_cast<int>(syscall(SYS_renameat, AT_FDCWD, from, AT_FDCWD, to));
}

namespace stereotlm::files {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

using Files = std::map<std::string, std::string>;  // contents by name

const Files kOld = {{"a", "old"}, {"frames/1", "old"}, {"gone", "old"}, {"mark", "old"}, {"z", "old"}};
const Files kNew = {{"a", "new"}, {"frames/2", "new"}, {"mark", "new"}, {"more", "new"}, {"z", "new"}};

class OutputFolderTest : public ::testing::Test {
 protected:
  static OutputContent content() {
    OutputContent content;
    content.called = "folder";
    content.mark = "mark";
    content.foreign = [](const fs::path& entry) {
      const std::string name = entry.filename();
      const bool is_ours = name == "frames" || kOld.count(name) + kNew.count(name) > 0;
      return is_ours ? std::nullopt : std::optional(name);
    };
    content.problem = [](const fs::path& /*dir*/, bool /*was_left*/) { return std::nullopt; };
    return content;
  }

  void write() const {
    OutputFolder folder(out_, content());
    for (const auto& [name, bytes] : kNew) folder.add(name, bytes);
    folder.commit();
  }

  // Runs `work` in a process that is killed by the rename after `renames` successful ones.
  static test::ChildResult killed(int renames, const std::function<void()>& work) {
    return test::run_in_child([renames, &work] {
      renames_left = renames;
      is_killed_there = true;
      work();
      return "";
    });
  }
  test::ChildResult write_killed(int renames) const {
    return killed(renames, [this] { write(); });
  }
  test::ChildResult begin_killed(int renames) const {
    return killed(renames, [this] { const OutputFolder folder(out_, content()); });
  }

  Files files() const {
    Files files;
    for (const auto& entry : fs::recursive_directory_iterator(out_)) {
      if (is_file(entry.path())) files[entry.path().lexically_relative(out_)] = test::read_file(entry.path());
    }
    return files;
  }
  void begin_with(const Files& files) const {
    fs::remove_all(out_);
    for (const auto& [name, bytes] : files) test::write_file(out_ / name, bytes);
    test::write_file(out_ / "note", "precious");
  }

  static Files with_note(Files files) {
    files["note"] = "precious";
    return files;
  }

  test::ScratchFolder scratch_;
  fs::path out_ = scratch_.path() / "out";
};

constexpr int kKilled = 128 + SIGKILL;
const std::vector<Files> kEarlier = {{}, kOld};

TEST_F(OutputFolderTest, IsAsItWasOrNewAfterACommitThatIsKilledAnywhere) {
  for (const Files& earlier : kEarlier) {
    int renames = 0;
    for (bool is_killed = true; is_killed; ++renames) {
      begin_with(earlier);
      is_killed = write_killed(renames).exit_status == kKilled;
      { const OutputFolder folder(out_, content()); }
      EXPECT_EQ(files(), with_note(is_killed ? earlier : kNew)) << renames;
      write();
      EXPECT_EQ(files(), with_note(kNew)) << renames;
    }
    EXPECT_EQ(renames, 1 + (earlier.empty() ? 5 : 10));  // all go well in the last one
  }
}

TEST_F(OutputFolderTest, IsAsItWasAfterItsRepairIsKilledAnywhere) {
  for (const Files& earlier : kEarlier) {
    const int most = earlier.empty() ? 5 : 10;
    for (int renames = 0; renames < most; ++renames) {
      for (int repaired = 0;; ++repaired) {
        begin_with(earlier);
        ASSERT_EQ(write_killed(renames).exit_status, kKilled);
        const bool is_killed = begin_killed(repaired).exit_status == kKilled;
        begin_killed(repaired / 2);
        { const OutputFolder folder(out_, content()); }
        EXPECT_EQ(files(), with_note(earlier)) << renames << ", " << repaired;
        if (!is_killed) break;
      }
    }
  }
}

TEST_F(OutputFolderTest, IsAsItWasAfterACommitThatFailsAnywhere) {
  for (const Files& earlier : kEarlier) {
    const int most = earlier.empty() ? 5 : 10;
    for (int renames = 0; renames < most; ++renames) {
      begin_with(earlier);
      renames_left = renames;
      EXPECT_THAT(test::message_of([this] { write(); }),
                  HasSubstr("the new files cannot be moved into place: Input/output error"));
      renames_left = -1;
      // Nothing could be put back, so nothing may be thrown away.
      { const OutputFolder folder(out_, content()); }
      EXPECT_EQ(files(), with_note(earlier)) << renames;
    }
  }
}

}  // namespace
}  // namespace stereotlm::files
