#include "sw/files/output_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <iterator>
#include <stdexcept>
#include <vector>

#include "tests/support/file_size_limit.h"
#include "tests/support/fork.h"
#include "tests/support/scratch_folder.h"

namespace stereotlm::files {
namespace {

namespace fs = std::filesystem;

const FileKind kKind = marked_kind("note of this test", {{0, "own"}, {4, ":"}});

class OutputFileTest : public ::testing::Test {
 protected:
  std::ptrdiff_t files() const { return std::distance(fs::directory_iterator(scratch_.path()), {}); }
  static void replace(const fs::path& path, const std::string& bytes) {
    OutputFile file(path, kKind);
    file.write(bytes);
    file.commit();
  }
  static std::string refusal(const fs::path& path, const std::vector<NamedFile>& others = {}) {
    return test::message_of([&] { const OutputFile file(path, kKind, others); });
  }

  test::ScratchFolder scratch_;
  fs::path path_ = scratch_.path() / "file";
};

TEST_F(OutputFileTest, AppearsCompleteAtTheCommit) {
  test::write_file(path_, "own : old");
  OutputFile file(path_, kKind);
  EXPECT_EQ(files(), 1) << "nothing is made before the first write";
  file.write("one, ");
  file.write("two");
  EXPECT_EQ(test::read_file(path_), "own : old");
  file.commit();
  EXPECT_EQ(test::read_file(path_), "one, two");
  EXPECT_EQ(files(), 1);
}

TEST_F(OutputFileTest, IsAsItWasWithoutACommit) {
  { OutputFile(path_, kKind).write("new"); }
  EXPECT_EQ(files(), 0);
  test::write_file(path_, "own : old");
  { OutputFile(path_, kKind).write("new"); }
  EXPECT_EQ(test::read_file(path_), "own : old");
  EXPECT_EQ(files(), 1);
}

TEST_F(OutputFileTest, MayBeWrittenByItsPathAndCompletedBeforeTheCommit) {
  test::write_file(path_, "own : old");
  OutputFile file(path_, kKind);
  test::write_file(file.aside().path(), "new");
  file.complete();
  EXPECT_EQ(test::read_file(path_), "own : old");
  file.commit();
  EXPECT_EQ(test::read_file(path_), "new");
  EXPECT_EQ(files(), 1);
}

// A file is replaced only if it is empty, or has all marks at their places.
TEST_F(OutputFileTest, ReplacesFilesOfItsKindAlone) {
  for (const char* const own : {"", "own :", "own : text", "own-:"}) {
    test::write_file(path_, own);
    replace(path_, "new");
    EXPECT_EQ(test::read_file(path_), "new") << own;
  }
  for (const char* const other : {"own", "own  :", " own :", "Own :", "other text with own :", "own"}) {
    test::write_file(path_, other);
    EXPECT_EQ(refusal(path_),
              "'" + path_.string() +
                  "': exists, and is not known as a note of this test, which alone is replaced: "
                  "move it away, or give another file");
    EXPECT_EQ(test::read_file(path_), other);
  }
}

TEST_F(OutputFileTest, ReplacesNothingThatHasAppearedSinceItWasMade) {
  for (const char* const text : {"own : of another process", "precious", ""}) {
    OutputFile file(path_, kKind);
    file.write("new");
    test::write_file(path_, text);
    EXPECT_THROW(file.commit(), std::runtime_error) << text;
    EXPECT_EQ(test::read_file(path_), text);
    fs::remove(path_);
  }
  test::write_file(path_, "own : old");
  OutputFile file(path_, kKind);
  file.write("new");
  test::write_file(path_, "precious");
  EXPECT_THAT(test::message_of([&] { file.commit(); }), ::testing::HasSubstr("is not known as a note"));
  EXPECT_EQ(test::read_file(path_), "precious");
}

TEST_F(OutputFileTest, MustNotBeAnotherFileOfTheCommand) {
  test::write_file(path_, "own : input");
  const fs::path link = scratch_.path() / "link";
  const fs::path hard_link = scratch_.path() / "hard";
  fs::create_symlink("file", link);
  fs::create_hard_link(path_, hard_link);
  const std::vector<NamedFile> input = {{"PLAN", ""}, {"BOARD", path_.string()}};
  for (const fs::path& path : {path_, link, hard_link, scratch_.path() / "." / "file"})
    EXPECT_EQ(refusal(path, input), "'" + path.string() + "': is the file of BOARD: must be another");
  fs::create_symlink("new", scratch_.path() / "to_new");
  for (const char* const name : {"new", "to_new"}) {
    const std::vector<NamedFile> output = {{"--out", (scratch_.path() / "." / name).string()}};
    EXPECT_THAT(refusal(scratch_.path() / "new", output), ::testing::HasSubstr("is the file of --out"));
    EXPECT_THAT(refusal(scratch_.path() / "to_new", output), ::testing::HasSubstr("is the file of --out"));
  }
}

TEST_F(OutputFileTest, MustNotLieInAResultFolder) {
  const fs::path a = scratch_.path() / "a";
  for (const char* const other : {"", "{}", R"({"command": "train", "run": 1})"}) {
    test::write_file(a / "run.json", other);
    EXPECT_NO_THROW(OutputFile(a / "file", kKind)) << other;
  }
  test::write_file(a / "run.json", R"({"schema": 1, "command": "run", "version": "0.1.0"})");
  fs::create_symlink("a", scratch_.path() / "b");
  fs::create_symlink("a/new", scratch_.path() / "c");
  for (const char* const name : {"a/file", "b/file", "a/none/deep/file", "b/../a/file", "c", "a/run.json"}) {
    EXPECT_EQ(refusal(scratch_.path() / name), "'" + (scratch_.path() / name).string() +
                                                   "': the result folder '" + a.string() +
                                                   "' of run holds nothing else: must lie elsewhere");
  }
  EXPECT_NO_THROW(OutputFile(scratch_.path() / "a_b", kKind));
}

TEST_F(OutputFileTest, IsNotWrittenBesideAJournalOfAnotherDatabase) {
  FileKind kind = kKind;
  kind.journals = {"-wal"};
  const std::string journal = test::write_file(path_.string() + "-wal", "changes");
  const auto refused = [&](const auto& action) {
    EXPECT_THAT(test::message_of(action),
                ::testing::HasSubstr("beside it lies 'file-wal' of an earlier database"));
  };
  refused([&] { const OutputFile file(path_, kind); });
  fs::remove(journal);
  OutputFile file(path_, kind);
  test::write_file(journal, "changes");
  refused([&] { file.commit(); });
  EXPECT_FALSE(fs::exists(path_));
}

TEST_F(OutputFileTest, LeavesAllOtherFilesAlone) {
  for (const char* name : {"file.part", ".file.write", ".other.writing"})
    test::write_file(scratch_.path() / name, "precious");
  replace(path_, "own : new");
  { OutputFile(path_, kKind).write("newer"); }
  EXPECT_EQ(test::read_file(path_), "own : new");
  EXPECT_EQ(test::read_file(scratch_.path() / "file.part"), "precious");
  EXPECT_EQ(files(), 4);
  const fs::path aside = scratch_.path() / ".file.writing";
  const std::string refusal = "'" + path_.string() + "': cannot be written: File exists";
  fs::create_directory(aside);
  EXPECT_EQ(test::message_of([this] { replace(path_, "newer"); }), refusal);
  fs::remove(aside);
  fs::create_symlink("file.part", aside);
  EXPECT_EQ(test::message_of([this] { replace(path_, "newer"); }), refusal);
  EXPECT_EQ(test::read_file(path_), "own : new");
}

TEST_F(OutputFileTest, RemovesTheFileOfAKilledProcess) {
  const auto killed = test::run_in_child([this] {
    OutputFile file(path_, kKind);
    file.write("half");
    raise(SIGKILL);
    return "";
  });
  EXPECT_EQ(killed.exit_status, 128 + SIGKILL);
  test::write_file(path_, "own : old");
  OutputFile living(path_, kKind);
  living.write("own : whole");
  EXPECT_EQ(files(), 2);
  EXPECT_EQ(test::message_of([this] { replace(path_, "own : other"); }),
            "'" + path_.string() + "': cannot be written: Device or resource busy");
  EXPECT_EQ(files(), 2) << "the file of the living one stays";
  living.commit();
  EXPECT_EQ(test::read_file(path_), "own : whole");
  EXPECT_EQ(files(), 1);
}

TEST_F(OutputFileTest, TakesTheLongestName) {
  const fs::path longest = scratch_.path() / std::string(255, 'n');
  replace(longest, "new");
  EXPECT_EQ(test::read_file(longest), "new");
}

TEST_F(OutputFileTest, LeavesNothingBehindAndNamesTheFileWhereItFails) {
  const std::string none = scratch_.path() / "none" / "file";
  EXPECT_EQ(refusal(none), "'" + none + "': there is no such folder");
  {
    const test::FileSizeLimit limit(10);
    EXPECT_EQ(test::message_of([this] { replace(path_, "more than ten"); }),
              "'" + path_.string() + "': cannot be written: File too large");
  }
  EXPECT_EQ(files(), 0);
  fs::create_directory(path_);
  EXPECT_EQ(refusal(path_), "'" + path_.string() + "': is no file");
  const std::string too_long = scratch_.path() / std::string(256, 'n');
  EXPECT_EQ(refusal(too_long), "'" + too_long + "': cannot be written: File name too long");
  fs::create_symlink("round", scratch_.path() / "round");
  EXPECT_THAT(refusal(scratch_.path() / "round"), ::testing::HasSubstr("Too many levels of symbolic links"));
  ASSERT_EQ(mkfifo((scratch_.path() / "fifo").c_str(), 0600), 0);
  EXPECT_THAT(refusal(scratch_.path() / "fifo"), ::testing::HasSubstr("is no file"));
  EXPECT_EQ(files(), 3);
}

TEST_F(OutputFileTest, ReplacesTheTargetOfALinkAndKeepsTheLink) {
  fs::create_directory(scratch_.path() / "real");
  const fs::path target = scratch_.path() / "real" / "target";
  fs::create_symlink("real/target", scratch_.path() / "second");
  fs::create_symlink(scratch_.path() / "second", path_);
  for (const char* const bytes : {"own : of a link to nothing", "own : of a link to a file"}) {
    replace(path_, bytes);
    EXPECT_EQ(test::read_file(target), bytes);
    EXPECT_TRUE(fs::is_symlink(path_) && fs::is_symlink(scratch_.path() / "second"));
    EXPECT_EQ(files(), 3);
  }
  test::write_file(target, "precious");
  EXPECT_THAT(refusal(path_), ::testing::HasSubstr("is not known as a note"));
}

TEST_F(OutputFileTest, KeepsItsModeAndItsOwner) {
  constexpr uid_t kOther = 4711;
  struct stat now = {};
  for (const mode_t mode : {0600U, 0664U, 0755U, 0440U}) {
    test::write_file(path_, "own : old");
    ASSERT_EQ(chmod(path_.c_str(), mode), 0);
    const bool is_given_away = chown(path_.c_str(), kOther, kOther) == 0;  // only root can
    replace(path_, "new");
    ASSERT_EQ(stat(path_.c_str(), &now), 0);
    EXPECT_EQ(now.st_mode & 07777U, mode);
    EXPECT_EQ(now.st_uid, is_given_away ? kOther : geteuid());
    EXPECT_EQ(now.st_gid, is_given_away ? kOther : getegid());
    fs::remove(path_);
  }
}

}  // namespace
}  // namespace stereotlm::files
