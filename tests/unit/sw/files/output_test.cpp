// What output_file.h promises, a test each. Kills and failures at every step: output_faults_test.cpp. How the
// program keeps the promises: refusals_test.py, ended_test.py.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "sw/files/output_folder.h"
#include "tests/support/file_size_limit.h"
#include "tests/support/fork.h"
#include "tests/support/scratch_folder.h"

namespace stereotlm::files {
namespace {

namespace fs = std::filesystem;
using test::message_of;
using test::read_file;
using test::write_file;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const FileKind kKind = marked_kind("note of this test", {{0, "own"}, {4, ":"}});

class OutputTest : public testing::Test {
 protected:
  std::vector<std::string> names() const {
    for (;;) {
      try {
        std::vector<std::string> names;
        for (const auto& entry : fs::recursive_directory_iterator(scratch_.path()))
          names.push_back(entry.path().lexically_relative(scratch_.path()));
        std::sort(names.begin(), names.end());
        return names;
      } catch (const fs::filesystem_error&) {  // what a killed process has left is just removed
      }
    }
  }
  static void replace(const fs::path& path, const std::string& bytes) {
    OutputFile file(path, kKind);
    file.write(bytes);
    file.commit();
  }
  static std::string refusal(const fs::path& path, const std::vector<NamedFile>& others = {}) {
    return message_of([&] { const OutputFile file(path, kKind, others); });
  }

  static OutputContent content(bool others_stay = false) {
    OutputContent content;
    content.called = "folder";
    content.mark = "doc";
    content.kind = kKind;
    content.rule = "must be moved away";
    content.names = {"doc", "a.csv", "frames/", "frames/+([0-9]).png"};
    content.others_stay = others_stay;
    return content;
  }
  std::unique_ptr<OutputFolder> open(const OutputContent& described = content()) const {
    return std::make_unique<OutputFolder>(out_, described);
  }
  std::string folder_refusal(const OutputContent& described = content()) const {
    const std::string message = message_of([&] { open(described); });
    const std::string begin = "folder '" + out_.string() + "': ";
    EXPECT_EQ(message.substr(0, begin.size()), begin);
    return message.substr(std::min(begin.size(), message.size()));
  }
  static void add_all(OutputFolder& folder) {
    folder.append("a.csv", "1,");
    folder.add("frames/1.png", std::vector<std::uint8_t>{'n', 'e', 'w'});
    folder.append("a.csv", "2");
    folder.add("doc", "own : new");
  }
  void expect_new() const {
    EXPECT_EQ(read_file(out_ / "a.csv"), "1,2");
    EXPECT_EQ(read_file(out_ / "frames/1.png"), "new");
    EXPECT_EQ(read_file(out_ / "doc"), "own : new");
  }
  void write_earlier() const {
    for (const char* name : {"doc", "a.csv", "frames/0.png"}) write_file(out_ / name, "own : old");
  }

  test::ScratchFolder scratch_;
  fs::path path_ = scratch_.path() / "file";
  fs::path out_ = scratch_.path() / "parent" / "out";
};

TEST_F(OutputTest, AFileIsAsItWasUntilTheCommitAndWholeAfterIt) {
  write_file(path_, "own : old");
  OutputFile file(path_, kKind);
  EXPECT_THAT(names(), ElementsAre("file")) << "nothing is made before the first write";
  file.write("one, ");
  file.write(std::string(1'000'000, 'x'));
  file.complete();
  EXPECT_EQ(read_file(path_), "own : old");
  file.commit();
  EXPECT_EQ(read_file(path_), "one, " + std::string(1'000'000, 'x'));
  EXPECT_THAT(names(), ElementsAre("file"));
}

TEST_F(OutputTest, AFileMayBeWrittenByItsPath) {
  const fs::path longest = scratch_.path() / std::string(255, 'n');
  OutputFile file(longest, kKind);
  write_file(file.unfinished(), "new");
  write_file(file.unfinished() += ".more", "");
  file.commit();
  EXPECT_EQ(read_file(longest), "new");
  EXPECT_THAT(names(), ElementsAre(std::string(255, 'n')));
}

TEST_F(OutputTest, AFolderIsAsItWasUntilTheCommitAndWholeAfterIt) {
  for (const bool has_earlier : {false, true}) {
    if (has_earlier) write_earlier();
    const auto folder = open();
    add_all(*folder);
    EXPECT_EQ(fs::exists(out_ / "doc"), has_earlier);
    if (has_earlier) {
      EXPECT_EQ(read_file(out_ / "doc"), "own : old");
    }
    folder->commit();
    expect_new();
    EXPECT_THAT(names(), ElementsAre("parent", "parent/out", "parent/out/a.csv", "parent/out/doc",
                                     "parent/out/frames", "parent/out/frames/1.png"));
    EXPECT_THROW(folder->commit(), std::logic_error);
  }
}

TEST_F(OutputTest, AFolderTakesTheFilesOfTheCommandAlone) {
  const auto folder = open();
  folder->add("a.csv", "x");
  for (const char* name : {"a.csv", "", "notes", "../doc", "frames/a.png", "frames", ".partial/doc", "1.png"})
    EXPECT_THROW(folder->add(name, "x"), std::invalid_argument) << name;
  EXPECT_THROW(folder->append("a.csv", "x"), std::invalid_argument);
  EXPECT_THROW(folder->commit(), std::logic_error) << "without its mark";
}

TEST_F(OutputTest, FilesOfTheKindAloneAreReplaced) {
  for (const char* const own : {"", "own :", "own-: text"}) {
    write_file(path_, own);
    replace(path_, "new");
    EXPECT_EQ(read_file(path_), "new") << own;
  }
  for (const char* const other : {"own", "own  :", " own :", "Own :", "other text with own :"}) {
    write_file(path_, other);
    EXPECT_EQ(refusal(path_), "'" + path_.string() +
                                  "': exists, and is not known as a note of this test, which alone is "
                                  "replaced: move it away, or give another file");
    EXPECT_EQ(read_file(path_), other);
  }
}

TEST_F(OutputTest, AFolderIsReplacedIfItHasItsMarkAndNothingElse) {
  write_file(out_ / "a.csv", "own : mine");
  const std::string no_mark = " but no doc that is a note of this test: must be moved away";
  EXPECT_EQ(folder_refusal(), "holds 'a.csv'" + no_mark);
  EXPECT_EQ(folder_refusal(content(true)), "holds 'a.csv'" + no_mark);
  write_file(out_ / "doc", "mine");
  EXPECT_EQ(folder_refusal(), "holds 'a.csv'" + no_mark);
  write_file(out_ / "doc", "own : old");
  const auto holds = [&](const std::string& name, const std::string& rule = ": must be moved away") {
    EXPECT_EQ(folder_refusal(), "holds '" + name + "'" + rule);
    EXPECT_TRUE(fs::exists(fs::symlink_status(out_ / name))) << "a refused folder is left as it is";
    fs::remove_all(out_ / name);
  };
  for (const char* name : {"thesis.tex", "frames/note", "frames/a.png", "frames/1.png.png"}) {
    write_file(out_ / name, "mine");
    holds(name);
  }
  fs::create_directories(out_ / "frames/1.png");
  holds("frames/1.png");
  fs::remove_all(out_ / "frames");
  write_file(out_ / "frames", "a file");
  holds("frames");
  fs::remove(out_ / "a.csv");
  fs::create_symlink("doc", out_ / "a.csv");
  holds("a.csv");
  write_file(out_ / ".partial", "a file");
  holds(".partial", ", which is no folder");
  write_file(out_ / ".partial/mine", "x");
  holds(".partial/mine", ", which no killed run has left there");
  EXPECT_NO_THROW(open());
}

TEST_F(OutputTest, OtherFilesInAFolderStay) {
  write_earlier();
  write_file(out_ / "run", "script");
  const auto folder = open(content(true));
  add_all(*folder);
  write_file(out_ / "appeared", "mine");
  folder->commit();
  expect_new();
  for (const char* name : {"run", "appeared"}) EXPECT_TRUE(fs::exists(out_ / name)) << name;
  EXPECT_FALSE(fs::exists(out_ / "frames/0.png"));
}

TEST_F(OutputTest, AFileThatHasAppearedIsNotReplaced) {
  for (const char* const text : {"own : of another process", "precious", ""}) {
    OutputFile file(path_, kKind);
    file.write("new");
    write_file(path_, text);
    EXPECT_THROW(file.commit(), std::runtime_error) << text;
    EXPECT_EQ(read_file(path_), text);
    fs::remove(path_);
  }
  write_file(path_, "own : old");
  OutputFile file(path_, kKind);
  file.write("new");
  write_file(path_, "precious");
  EXPECT_THAT(message_of([&] { file.commit(); }), HasSubstr("is not known as a note"));
  EXPECT_EQ(read_file(path_), "precious");
}

TEST_F(OutputTest, WhatHasAppearedInAFolderIsNotReplaced) {
  const std::string moved = "the new files cannot be moved into place: ";
  for (const auto& [name, cause] :
       {std::pair("a.csv", moved + "a.csv: File exists"), std::pair("doc", moved + "doc: File exists"),
        std::pair("frames/note", std::string("has been given 'frames/note'"))}) {
    if (name == std::string("a.csv")) write_file(out_ / "doc", "own : old");
    if (name == std::string("frames/note")) write_earlier();
    auto folder = open();
    add_all(*folder);
    write_file(out_ / name, "mine");
    EXPECT_THAT(message_of([&] { folder->commit(); }), HasSubstr(cause));
    folder.reset();
    EXPECT_EQ(read_file(out_ / name), "mine");
    if (name != std::string("doc")) {
      EXPECT_EQ(read_file(out_ / "doc"), "own : old");
    }
    EXPECT_FALSE(fs::exists(out_ / ".partial") || fs::exists(out_ / "frames/1.png"));
    fs::remove_all(out_);
  }
}

TEST_F(OutputTest, AFileThatTheCommandUsesIsNotReplaced) {
  write_file(path_, "own : input");
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
    EXPECT_THAT(refusal(scratch_.path() / "new", output), HasSubstr("is the file of --out"));
    EXPECT_THAT(refusal(scratch_.path() / "to_new", output), HasSubstr("is the file of --out"));
  }
  write_earlier();
  fs::create_symlink(out_ / "a.csv", scratch_.path() / "to_table");
  OutputContent described = content(true);
  for (const fs::path& path : {out_ / "a.csv", scratch_.path() / "to_table"}) {
    described.inputs = {{"--left", path}};
    EXPECT_EQ(folder_refusal(described),
              "--left '" + path.string() + "' lies in it and would be replaced: an input must lie elsewhere");
  }
  described.inputs = {{"--left", write_file(out_ / "other", "mine")}};
  EXPECT_NO_THROW(open(described));
}

TEST_F(OutputTest, NothingIsWrittenIntoAResultFolder) {
  const fs::path a = scratch_.path() / "a";
  for (const char* const other : {"", "{}", R"({"command": "train", "run": 1})"}) {
    write_file(a / "run.json", other);
    EXPECT_NO_THROW(OutputFile(a / "file", kKind)) << other;
  }
  write_file(a / "run.json", R"({"schema": 1, "command": "run", "version": "0.1.0"})");
  fs::create_symlink("a", scratch_.path() / "b");
  fs::create_symlink("a/new", scratch_.path() / "c");
  const std::string rule =
      "the result folder '" + a.string() + "' of run holds nothing else: must lie elsewhere";
  for (const char* const name : {"a/file", "b/file", "a/none/deep/file", "b/../a/file", "c", "a/run.json"})
    EXPECT_EQ(refusal(scratch_.path() / name), "'" + (scratch_.path() / name).string() + "': " + rule);
  EXPECT_NO_THROW(OutputFile(scratch_.path() / "a_b", kKind));
  for (const char* const name : {"a", "a/new", "b"}) {
    out_ = scratch_.path() / name;
    EXPECT_EQ(folder_refusal(content(true)), rule);
  }
  OutputContent result = content(true);
  result.mark = kResultMark;
  out_ = a;
  EXPECT_NO_THROW(open(result));
}

TEST_F(OutputTest, AFileIsNotWrittenBesideAJournalOfAnotherDatabase) {
  FileKind kind = kKind;
  kind.journals = {"-wal"};
  OutputFile file(path_, kind);
  write_file(path_.string() + "-wal", "changes");
  const std::string problem = "beside it lies 'file-wal' of an earlier database";
  EXPECT_THAT(message_of([&] { file.commit(); }), HasSubstr(problem));
  EXPECT_THAT(message_of([&] { OutputFile(path_, kind); }), HasSubstr(problem));
  EXPECT_FALSE(fs::exists(path_));
}

TEST_F(OutputTest, OneProcessAtATimeWrites) {
  OutputFile file(path_, kKind);
  file.write("own : whole");
  EXPECT_EQ(message_of([this] { replace(path_, "own : other"); }),
            "'" + path_.string() + "': cannot be written: Device or resource busy");
  file.commit();
  EXPECT_EQ(read_file(path_), "own : whole");
  const auto folder = open();
  add_all(*folder);
  EXPECT_EQ(folder_refusal(), "in use by another run");
  OutputContent other = content();
  other.prefix = "other";
  other.others_stay = true;
  EXPECT_NO_THROW(open(other));
  folder->commit();
  expect_new();
}

TEST_F(OutputTest, NothingUnfinishedIsLeft) {
  { OutputFile(path_, kKind).write("new"); }
  add_all(*open());
  EXPECT_THAT(names(), IsEmpty()) << "not even the folders that were made";
  for (const bool has_earlier : {false, true}) {
    if (has_earlier) write_earlier();
    const auto before = names();
    const auto end = test::run_in_child([this] {
      const auto folder = open();
      OutputFile file(path_, kKind);
      add_all(*folder);
      file.write("half");
      raise(SIGKILL);
      return "";
    });
    EXPECT_EQ(end.exit_status, 128 + SIGKILL);
    for (int tries = 0; names() != before && tries < 1000; ++tries) usleep(10'000);
    EXPECT_EQ(names(), before);
  }
  // What the end of the machine leaves is removed by the next command.
  write_file(out_ / ".partial/new/frames/1.png", "half");
  write_file(scratch_.path() / ".file.writing/new", "half");
  add_all(*open());
  replace(path_, "own : new");
  EXPECT_EQ(read_file(out_ / "doc"), "own : old");
  EXPECT_FALSE(fs::exists(out_ / ".partial") || fs::exists(scratch_.path() / ".file.writing"));
  // A folder that was made stays if it has got a file.
  fs::remove_all(out_);
  {
    const auto folder = open();
    write_file(out_.parent_path() / "note", "x");
  }
  EXPECT_THAT(names(), ElementsAre("file", "parent", "parent/note"));
}

TEST_F(OutputTest, TheFilesOfOthersWithItsHiddenNameStay) {
  for (const char* name : {".file.writing/precious", ".file.writing"}) {
    write_file(scratch_.path() / name, "precious");
    EXPECT_THAT(message_of([this] { replace(path_, "new"); }), HasSubstr("file': cannot be written: "));
    EXPECT_EQ(read_file(scratch_.path() / name), "precious");
    fs::remove_all(scratch_.path() / ".file.writing");
  }
}

TEST_F(OutputTest, ALinkToAFileStays) {
  fs::create_directory(scratch_.path() / "real");
  const fs::path target = scratch_.path() / "real" / "target";
  fs::create_symlink("real/target", scratch_.path() / "second");
  fs::create_symlink(scratch_.path() / "second", path_);
  for (const char* const bytes : {"own : of a link to nothing", "own : of a link to a file"}) {
    replace(path_, bytes);
    EXPECT_EQ(read_file(target), bytes);
    EXPECT_TRUE(fs::is_symlink(path_) && fs::is_symlink(scratch_.path() / "second"));
  }
  write_file(target, "precious");
  EXPECT_THAT(refusal(path_), HasSubstr("is not known as a note"));
  fs::create_directories(out_);
  fs::create_directory_symlink(out_, scratch_.path() / "to_out");
  out_ = scratch_.path() / "to_out" / "";
  const auto folder = open();
  add_all(*folder);
  folder->commit();
  expect_new();
}

TEST_F(OutputTest, AFileKeepsItsModeAndItsOwner) {
  constexpr uid_t kOther = 4711;
  struct stat now = {};
  for (const mode_t mode : {0600U, 0664U, 0755U, 0440U}) {
    write_file(path_, "own : old");
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

TEST_F(OutputTest, AnErrorNamesTheFileAndTheCause) {
  const std::string none = scratch_.path() / "none" / "file";
  EXPECT_EQ(refusal(none), "'" + none + "': there is no such folder");
  fs::create_directory(path_);
  EXPECT_EQ(refusal(path_), "'" + path_.string() + "': is no file");
  const std::string too_long = scratch_.path() / std::string(256, 'n');
  EXPECT_EQ(refusal(too_long), "'" + too_long + "': cannot be written: File name too long");
  fs::create_symlink("round", scratch_.path() / "round");
  EXPECT_THAT(refusal(scratch_.path() / "round"), HasSubstr("Too many levels of symbolic links"));
  ASSERT_EQ(mkfifo((scratch_.path() / "fifo").c_str(), 0600), 0);
  EXPECT_THAT(refusal(scratch_.path() / "fifo"), HasSubstr("is no file"));
  const std::string plain = write_file(scratch_.path() / "plain", "");
  fs::create_symlink("nowhere", scratch_.path() / "dangling");
  for (const auto& [path, problem] : {std::pair(plain, "not a folder"),
                                      {plain + "/out", "cannot be written to: Not a directory"},
                                      {scratch_.path() / "dangling", "not a folder"},
                                      {"/proc/self/fd", "cannot be written to: No such file or directory"}}) {
    out_ = path;
    EXPECT_EQ(folder_refusal(), problem);
  }
  out_ = "";
  EXPECT_EQ(folder_refusal(), "must be named");
}

TEST_F(OutputTest, ADiskThatIsFullIsNamedAndNothingIsLeft) {
  write_earlier();
  const auto before = names();
  {
    const test::FileSizeLimit limit(100);
    EXPECT_EQ(message_of([this] { replace(path_, std::string(101, 'x')); }),
              "'" + path_.string() + "': cannot be written: File too large");
    const auto folder = open();
    folder->add("doc", std::string(100, 'x'));
    EXPECT_EQ(message_of([&] { folder->add("a.csv", std::string(101, 'x')); }),
              "folder '" + out_.string() + "': 'a.csv' cannot be written: File too large");
  }
  {
    const test::FileSizeLimit limit(0);
    EXPECT_EQ(folder_refusal(), "cannot be written to: File too large");
  }
  EXPECT_EQ(names(), before);
  EXPECT_EQ(read_file(out_ / "doc"), "own : old");
}

}  // namespace
}  // namespace stereotlm::files
