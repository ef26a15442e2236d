// Output files when the process is killed, or a call of the file system fails, at any step. Its own program,
// because it takes the place of functions of the C library.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <map>
#include <stdexcept>
#include <string>

#include "sw/files/output_folder.h"
#include "tests/support/fork.h"
#include "tests/support/scratch_folder.h"

namespace {

enum class Fault { kKill, kKillInRename, kFailOnce, kFailFromThenOn };

int steps_left = -1;  // calls that still succeed before the fault; negative: no fault
Fault fault = Fault::kKill;
int failures = 0;

// Counts a call that changes the file system. Returns whether that call is to fail, and then sets errno.
bool fails(bool is_rename = false) {
  if (steps_left < 0 || (fault == Fault::kKillInRename && !is_rename)) return false;
  if (steps_left > 0) {
    --steps_left;
    return false;
  }
  if (fault == Fault::kKill || fault == Fault::kKillInRename) raise(SIGKILL);
  if (fault == Fault::kFailOnce) steps_left = -1;
  ++failures;
  errno = EIO;
  return true;
}

int call(long number, long a, long b, long c = 0, long d = 0) {
  return fails() ? -1 : static_cast<int>(syscall(number, a, b, c, d));
}
long address(const char* path) { return reinterpret_cast<long>(path); }

}  // namespace

// These functions replace those of the C library, so that a test can make the n-th call fail.
extern "C" {
int fsync(int /*file*/) { return fails() ? -1 : 0; }  // syncs nothing, which would be slow
int rename(const char* from, const char* to) noexcept {
  return fails(true) ? -1 : static_cast<int>(syscall(SYS_renameat, AT_FDCWD, from, AT_FDCWD, to));
}
int renameat2(int /*folder*/, const char* from, int /*folder*/, const char* to, unsigned flags) noexcept {
  return fails(true) ? -1 : static_cast<int>(syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, flags));
}
int mkdir(const char* path, mode_t mode) noexcept {
  return call(SYS_mkdirat, AT_FDCWD, address(path), static_cast<long>(mode));
}
int unlinkat(int folder, const char* path, int flags) noexcept {
  return call(SYS_unlinkat, folder, address(path), flags);
}
int unlink(const char* path) noexcept { return call(SYS_unlinkat, AT_FDCWD, address(path)); }
int rmdir(const char* path) noexcept { return call(SYS_unlinkat, AT_FDCWD, address(path), AT_REMOVEDIR); }
int remove(const char* path) noexcept {
  const int file = unlink(path);
  return file != 0 && errno == EISDIR ? rmdir(path) : file;
}
ssize_t write(int file, const void* bytes, size_t count) {
  return fails() ? -1 : syscall(SYS_write, file, bytes, count);
}
int open(const char* path, int flags, ...) {
  va_list more;
  va_start(more, flags);
  const long mode = (flags & O_CREAT) != 0 ? static_cast<long>(va_arg(more, mode_t)) : 0;
  va_end(more);
  if ((flags & O_CREAT) != 0 && fails()) return -1;
  return static_cast<int>(syscall(SYS_openat, AT_FDCWD, path, flags, mode));
}
}

namespace stereotlm::files {
namespace {

namespace fs = std::filesystem;

using Files = std::map<std::string, std::string>;  // contents by name

const Files kNone;
const Files kOld = {
    {"doc", "own : old"}, {"a.lut", "old"}, {"drawings/0.png", "old"}, {"drawings/x.png", "old"}};
const Files kNew = {
    {"doc", "own : new"}, {"a.lut", "new"}, {"drawings/1.png", "new"}, {"drawings/x.png", "new"}};

class OutputFaultsTest : public ::testing::Test {
 protected:
  OutputFaultsTest() {
    content_.called = "folder";
    content_.mark = "doc";
    content_.kind = marked_kind("document", {{0, "own"}});
    content_.others_stay = true;
    content_.names = {"doc", "*.lut", "drawings/", "drawings/*.png"};
  }

  void write(const Files& files) const {
    OutputFolder output(folder_, content_);
    for (const auto& [name, bytes] : files) output.add(name, bytes);
    output.commit();
  }
  // As a run that is given up before it writes.
  void begin() const { const OutputFolder output(folder_, content_); }

  void begin_with(const Files& files) const {
    fs::remove_all(folder_);
    for (const auto& [name, bytes] : files) test::write_file(folder_ / name, bytes);
    test::write_file(folder_ / "other", "precious");
  }
  Files files() const {
    Files files;
    for (const auto& entry : fs::recursive_directory_iterator(folder_)) {
      if (entry.is_regular_file())
        files[entry.path().lexically_relative(folder_)] = test::read_file(entry.path());
    }
    EXPECT_EQ(files["other"], "precious");
    files.erase("other");
    return files;
  }

  // Runs `work` in a process with a fault after `steps` calls that change the file system. Returns whether
  // the fault killed the process.
  template <typename Work>
  static bool is_killed(Fault kind, int steps, const Work& work) {
    const auto end = test::run_in_child([&] {
      fault = kind;
      steps_left = steps;
      work();
      steps_left = -1;
      return "";
    });
    return end.exit_status == 128 + SIGKILL;
  }

  // Runs `work` with a failure after `steps` calls. Returns whether it has come to that call.
  template <typename Work>
  static bool has_failed(Fault kind, int steps, const Work& work) {
    fault = kind;
    steps_left = steps;
    failures = 0;
    try {
      work();
    } catch (const std::runtime_error&) {
      EXPECT_GT(failures, 0);
    }
    steps_left = -1;
    return failures > 0;
  }

  // Makes attempts to write the fresh files with a fault at the first, second, .. call that changes the file
  // system, until the fault is not reached. After each attempt and the beginning of another command, the
  // files must be the earlier or the fresh ones, and writing must succeed.
  void at_every_step(Fault kind, const Files& earlier, const Files& fresh) const {
    const auto work = [&] { write(fresh); };
    int steps = 0;
    for (bool is_reached = true; is_reached; ++steps) {
      begin_with(earlier);
      is_reached = kind == Fault::kKill ? is_killed(kind, steps, work) : has_failed(kind, steps, work);
      begin();
      const Files found = files();
      EXPECT_TRUE(found == earlier || found == fresh) << steps;
      EXPECT_TRUE(is_reached || found == fresh);
      write(fresh);
      EXPECT_EQ(files(), fresh) << steps;
    }
    EXPECT_GT(steps, 10);
  }

  test::ScratchFolder scratch_;
  fs::path folder_ = scratch_.path() / "out";
  OutputContent content_;
};

TEST_F(OutputFaultsTest, AFolderIsAsItWasOrNewAfterAKillOrAFailureAnywhere) {
  for (const Fault kind : {Fault::kKill, Fault::kFailOnce, Fault::kFailFromThenOn}) {
    for (const Files& earlier : {kNone, kOld}) at_every_step(kind, earlier, kNew);
  }
}

// Such as the figures of `plot`.
TEST_F(OutputFaultsTest, FilesWithoutAMarkAreAsTheyWereOrNewAfterAKillOrAFailureAnywhere) {
  content_.mark = "";
  content_.kind = {"figure", [](const fs::path&) { return true; }};
  content_.names = {"*.csv", "*.png"};
  for (const Fault kind : {Fault::kKill, Fault::kFailOnce})
    at_every_step(kind, {{"a.csv", "old"}, {"a.png", "old"}, {"b.png", "old"}},
                  {{"a.csv", "new"}, {"c.png", "new"}});
}

// Once all earlier files are moved away, the next run completes the commit; before, it undoes it.
TEST_F(OutputFaultsTest, AFolderIsAsItWasOrNewAfterItsRepairIsKilledAnywhere) {
  for (const Files& earlier : {kNone, kOld}) {
    const int moved_away = earlier.empty() ? 0 : 3;
    int steps = 0;
    for (bool has_begun = true; has_begun; ++steps) {
      for (int repaired = 0, is_repaired = false; !is_repaired; ++repaired) {
        begin_with(earlier);
        has_begun = is_killed(Fault::kKillInRename, steps, [&] { write(kNew); });
        is_repaired = !is_killed(Fault::kKillInRename, repaired, [&] { begin(); });
        is_killed(Fault::kKillInRename, repaired / 2, [&] { begin(); });
        begin();
        EXPECT_EQ(files(), steps <= moved_away ? earlier : kNew) << steps << ", " << repaired;
      }
    }
    EXPECT_EQ(steps, moved_away + 1 + 3 + 1);  // all go well in the last one
  }
}

// A user's file that takes the name of a new file between a kill and the next run stops the repair.
TEST_F(OutputFaultsTest, ARepairReplacesNoFileOfTheUser) {
  begin_with(kNone);
  ASSERT_TRUE(is_killed(Fault::kKillInRename, 1, [this] { write(kNew); }));  // nothing is in place yet
  test::write_file(folder_ / "a.lut", "mine");
  EXPECT_EQ(test::message_of([this] { begin(); }),
            "folder '" + folder_.string() + "': cannot be written to: a.lut: File exists");
  EXPECT_EQ(test::read_file(folder_ / "a.lut"), "mine");
  fs::remove(folder_ / "a.lut");
  begin();
  EXPECT_EQ(files(), kNew);
}

TEST_F(OutputFaultsTest, AFileIsAsItWasOrNewAfterAKillOrAFailureAnywhere) {
  const fs::path path = folder_ / "note";
  const FileKind kind = marked_kind("note", {{0, "own"}});
  const auto replace = [&] {
    OutputFile file(path, kind);
    file.write("own : new");
    file.commit();
  };
  for (const Fault kind_of_fault : {Fault::kKill, Fault::kFailOnce, Fault::kFailFromThenOn}) {
    int steps = 0;
    for (bool is_reached = true; is_reached; ++steps) {
      begin_with({{"note", "own : old"}});
      is_reached = kind_of_fault == Fault::kKill ? is_killed(kind_of_fault, steps, replace)
                                                 : has_failed(kind_of_fault, steps, replace);
      const std::string found = test::read_file(path);
      EXPECT_TRUE(found == "own : new" || (is_reached && found == "own : old")) << steps;
      replace();
      EXPECT_EQ(files(), (Files{{"note", "own : new"}}));
    }
    EXPECT_GT(steps, 5);
  }
}

}  // namespace
}  // namespace stereotlm::files
