#include "sw/report/temporary_folder.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/support/scratch_folder.h"

namespace stereotlm::report {
namespace {

namespace fs = std::filesystem;

class TemporaryFolderTest : public ::testing::Test {
 protected:
  TemporaryFolderTest() { unset_all(); }
  ~TemporaryFolderTest() override { unset_all(); }
  static void unset_all() {
    for (const char* variable : {"TMPDIR", "TMP", "TEMP", "TEMPDIR"}) unsetenv(variable);
  }
  void set(const char* variable, const std::string& value) const { setenv(variable, value.c_str(), 1); }

  std::string refusal() const {
    return test::message_of([] { const TemporaryFolder folder; });
  }

  test::ScratchFolder scratch_;
};

TEST_F(TemporaryFolderTest, LiesWhereTheEnvironmentSays) {
  EXPECT_EQ(temporary_place().folder, "/tmp");
  for (const char* variable : {"TEMPDIR", "TEMP", "TMP", "TMPDIR"}) {
    set(variable, scratch_.path() / variable);
    EXPECT_EQ(temporary_place().variable, variable);
    EXPECT_EQ(temporary_place().folder, scratch_.path() / variable);
  }
  set("TMPDIR", "");
  EXPECT_EQ(temporary_place().variable, "TMP");
}

TEST_F(TemporaryFolderTest, GoesWithItsFiles) {
  set("TMPDIR", scratch_.path());
  {
    const TemporaryFolder folder;
    EXPECT_EQ(folder.path().parent_path(), scratch_.path());
    test::write_file(folder.path() / "file", "x");
  }
  EXPECT_TRUE(fs::is_empty(scratch_.path()));
}

TEST_F(TemporaryFolderTest, NamesAPlaceThatIsNoFolder) {
  set("TMPDIR", "/nonexistent");
  EXPECT_EQ(refusal(), "TMPDIR = /nonexistent: must be a folder");
  const std::string file = test::write_file(scratch_.path() / "file", "");
  set("TMPDIR", file);
  EXPECT_EQ(refusal(), "TMPDIR = " + file + ": must be a folder");
  set("TMPDIR", file + "/below");
  EXPECT_EQ(refusal(), "TMPDIR = " + file + "/below: must be a folder");
  unsetenv("TMPDIR");
  set("TEMP", "/proc");
  EXPECT_EQ(refusal(),
            "TEMP = /proc: must be a folder that takes temporary files: No such file or directory");
}

}  // namespace
}  // namespace stereotlm::report
