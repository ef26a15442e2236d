// How `calibrate` behaves when a call of the file system fails or the process is killed. files::OutputFolder,
// which also writes results and documents, is tested only here.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <map>
#include <stdexcept>
#include <string>

#include "calib/calibration.h"
#include "sw/files/output_folder.h"
#include "sw/files/whole_file.h"
#include "sw/media/synthetic_rig.h"
#include "sw/runs/sources/calibration_input.h"
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

namespace stereotlm::cli {
namespace {

namespace fs = std::filesystem;

using Files = std::map<std::string, std::string>;  // contents by name

std::string calibration_text() {
  calib::Calibration made;
  made.grid = {9, 6, 25.4};
  made.rig = media::SyntheticRig(2, 320, 240).rig();
  made.rectification = calib::rectify(made.rig);
  made.disparities = 80;
  return calib::calibration_yaml(made);
}

// A calibration; one that differs for each `what`.
Files calibration(const std::string& what, bool has_pictures) {
  static const std::string text = calibration_text();
  Files files = {{"rig.yaml", text + "# " + what + '\n'},
                 {"rig_left.lut", what},
                 {"rig_right.lut", what},
                 {what == "new" ? "rig_drawings/corners_01.png" : "rig_drawings/corners_00.png", what},
                 {"rig_drawings/displacement.png", what}};
  if (has_pictures) files["rig_pictures/left_00.png"] = what;
  return files;
}

struct CalibrationOutput : files::OutputFolder {
  CalibrationOutput(const fs::path& folder, bool makes_pictures, const std::string& name = "rig.yaml")
      : OutputFolder(folder, runs::calibration_content(runs::rig_files(folder / name), makes_pictures)) {}
};

class CalibrationOutputTest : public ::testing::Test {
 protected:
  void write(const Files& files) const {
    CalibrationOutput output(folder_, files.count("rig_pictures/left_00.png") > 0);
    for (const auto& [name, bytes] : files) output.add(name, bytes);
    output.commit();
  }
  // As a run that is given up before it has calibrated.
  void begin(bool makes_pictures) const { const CalibrationOutput output(folder_, makes_pictures); }

  void begin_with(const Files& files) const {
    fs::remove_all(folder_);
    for (const auto& [name, bytes] : files) test::write_file(folder_ / name, bytes);
    test::write_file(folder_ / "other_left.lut", "precious");
  }
  Files files() const {
    Files files;
    for (const auto& entry : fs::recursive_directory_iterator(folder_)) {
      if (files::is_file(entry.path()))
        files[entry.path().lexically_relative(folder_)] = test::read_file(entry.path());
    }
    EXPECT_EQ(files["other_left.lut"], "precious");
    files.erase("other_left.lut");
    return files;
  }

  // The files of `fresh` in place of the earlier ones; pictures that it does not make stay.
  static Files after(const Files& earlier, const Files& fresh) {
    Files files = fresh;
    const auto pictures = earlier.find("rig_pictures/left_00.png");
    if (pictures != earlier.end()) files.insert(*pictures);
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

  // Makes attempts with a fault at the first, second, .. call that changes the file system, until the fault
  // is not reached. `attempt(steps, fresh)` writes `fresh` with a fault after `steps` calls, and returns
  // whether the fault was reached. After each attempt the files must be the earlier or the fresh ones, and
  // writing `fresh` again must succeed.
  template <typename Attempt>
  void at_every_step(const Files& earlier, const Files& fresh, const Attempt& attempt) const {
    int steps = 0;
    for (bool has_failed = true; has_failed; ++steps) {
      begin_with(earlier);
      has_failed = attempt(steps, fresh);
      begin(earlier.count("rig_pictures/left_00.png") > 0);
      const Files found = files();
      EXPECT_TRUE(found == earlier || found == after(earlier, fresh)) << steps;
      EXPECT_TRUE(has_failed || found == after(earlier, fresh));
      write(fresh);
      EXPECT_EQ(files(), after(earlier, fresh)) << steps;
    }
    EXPECT_GT(steps, 30);
  }

  test::ScratchFolder scratch_;
  fs::path folder_ = scratch_.path() / "rigs";
};

TEST_F(CalibrationOutputTest, IsAsItWasOrNewAfterAKillAnywhere) {
  const auto attempt = [this](int steps, const Files& fresh) {
    return is_killed(Fault::kKill, steps, [&] { write(fresh); });
  };
  at_every_step({}, calibration("new", false), attempt);
  at_every_step(calibration("old", false), calibration("new", false), attempt);
  at_every_step(calibration("old", false), calibration("new", true), attempt);
  at_every_step(calibration("old", true), calibration("new", false), attempt);
}

// Once all earlier files are moved away, the next run completes the commit; before, it undoes it.
TEST_F(CalibrationOutputTest, IsAsItWasOrNewAfterItsRepairIsKilledAnywhere) {
  const Files fresh = calibration("new", true);
  for (const Files& earlier : {Files(), calibration("old", true)}) {
    const int moved_away = earlier.empty() ? 0 : 5;
    int steps = 0;
    for (bool has_begun = true; has_begun; ++steps) {
      for (int repaired = 0, is_repaired = false; !is_repaired; ++repaired) {
        begin_with(earlier);
        has_begun = is_killed(Fault::kKillInRename, steps, [&] { write(fresh); });
        is_repaired = !is_killed(Fault::kKillInRename, repaired, [&] { begin(true); });
        is_killed(Fault::kKillInRename, repaired / 2, [&] { begin(true); });
        begin(true);
        EXPECT_EQ(files(), steps <= moved_away ? earlier : fresh) << steps << ", " << repaired;
      }
    }
    EXPECT_EQ(steps, moved_away + 1 + 5 + 1);  // all go well in the last one
  }
}

TEST_F(CalibrationOutputTest, IsAsItWasOrNewAfterAFailureAnywhere) {
  for (const Fault kind : {Fault::kFailOnce, Fault::kFailFromThenOn}) {
    const auto attempt = [this, kind](int steps, const Files& fresh) {
      fault = kind;
      steps_left = steps;
      failures = 0;
      try {
        write(fresh);
      } catch (const std::runtime_error&) {
        EXPECT_GT(failures, 0);
      }
      steps_left = -1;
      return failures > 0;
    };
    at_every_step({}, calibration("new", true), attempt);
    at_every_step(calibration("old", true), calibration("new", false), attempt);
  }
}

// Such as the figures of `plot`.
TEST_F(CalibrationOutputTest, FilesWithoutAMarkAreAsTheyWereOrNewAfterAKillOrAFailureInAnyMove) {
  files::OutputContent content;
  content.called = "folder";
  content.kind = {"figure", [](const fs::path&) { return true; }};
  content.others_stay = true;
  content.names = {"[ab].*"};
  const Files earlier = {{"a.csv", "old"}, {"a.png", "old"}, {"a.svg", "old"}};
  const Files fresh = {{"a.csv", "new"}, {"a.pdf", "new"}, {"b.png", "new"}};
  const auto write_all = [&] {
    files::OutputFolder folder(folder_, content);
    for (const auto& [name, bytes] : fresh) folder.add(name, bytes);
    folder.commit();
  };
  // Three files are moved away, a rename completes the new ones, and three are moved into place.
  for (int steps = 0; steps <= 7; ++steps) {
    begin_with(earlier);
    EXPECT_EQ(is_killed(Fault::kKillInRename, steps, write_all), steps < 7);
    const files::OutputFolder cleaned(folder_, content);
    EXPECT_EQ(files(), steps < 4 ? earlier : fresh) << steps;
  }
  int steps = 0;
  for (failures = 1; failures > 0; ++steps) {
    begin_with(earlier);
    fault = Fault::kFailOnce;
    failures = 0;
    steps_left = steps;
    try {
      write_all();
    } catch (const std::runtime_error&) {
      EXPECT_GT(failures, 0);
      steps_left = -1;
      const files::OutputFolder cleaned(folder_, content);
      EXPECT_EQ(files(), earlier) << steps;
    }
    steps_left = -1;
  }
  EXPECT_EQ(files(), fresh);
  EXPECT_GT(steps, 10);
}

TEST_F(CalibrationOutputTest, TakesTurnsWithAnotherRunOfTheSameNameAlone) {
  begin_with(calibration("old", false));
  {
    const CalibrationOutput first(folder_, false);
    EXPECT_THAT(test::message_of([&] { CalibrationOutput(folder_, false); }),
                testing::HasSubstr("in use by another run"));
    const CalibrationOutput other(folder_, false, "rig2.yaml");
  }
  EXPECT_EQ(files(), calibration("old", false));
}

}  // namespace
}  // namespace stereotlm::cli
