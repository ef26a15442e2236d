#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <climits>
#include <cstdlib>
#include <string>

#include "sw/files/aside.h"
#include "tests/support/scratch_folder.h"

namespace stereotlm::files {
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

TEST_F(TemporaryFolderTest, LiesInTheFolderThatTheEnvironmentNames) {
  EXPECT_EQ(TemporaryFolder().path().parent_path(), "/tmp");
  for (const char* variable : {"TEMPDIR", "TEMP", "TMP", "TMPDIR"}) {
    const fs::path folder = scratch_.path() / variable;
    set(variable, folder);
    EXPECT_EQ(refusal(), variable + (" = " + folder.string()) + ": must be a folder");
  }
  set("TMPDIR", "");
  EXPECT_THAT(refusal(), testing::StartsWith("TMP = "));
  set("TMPDIR", test::write_file(scratch_.path() / "file", ""));
  EXPECT_THAT(refusal(), testing::EndsWith("/file: must be a folder"));
}

TEST_F(TemporaryFolderTest, IsRemovedWithItsFiles) {
  set("TMPDIR", scratch_.path());
  {
    const TemporaryFolder folder;
    EXPECT_EQ(folder.path().parent_path(), scratch_.path());
    test::write_file(folder.path() / "file", "x");
  }
  EXPECT_TRUE(fs::is_empty(scratch_.path()));
}

TEST_F(TemporaryFolderTest, NamesAFolderThatTakesNoFiles) {
  // The path of a folder in it would be longer than a path can be.
  fs::path deep = scratch_.path();
  while (deep.native().size() + 102 < PATH_MAX) deep /= std::string(100, 'd');
  deep /= std::string(PATH_MAX - 2 - deep.native().size(), 'd');
  fs::create_directories(deep);
  set("TEMP", deep);
  EXPECT_EQ(refusal(),
            "TEMP = " + deep.string() + ": must be a folder that takes temporary files: File name too long");
}

}  // namespace
}  // namespace stereotlm::files
