// A folder in which other files stay. A folder that holds nothing else is tested with the results of `run`,
// and failures and kills with the files of `calibrate`.
#include "sw/files/output_folder.h"

#include <gmock/gmock.h>

#include <memory>

#include "tests/support/scratch_folder.h"

namespace stereotlm::files {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class OutputFolderTest : public testing::Test {
 protected:
  std::unique_ptr<OutputFolder> open(const std::vector<NamedFile>& inputs = {}) const {
    OutputContent content;
    content.called = "folder";
    content.mark = "doc.md";
    content.kind = marked_kind("document of this test", {{0, "ours"}});
    content.rule = "must be moved away";
    content.names = {"doc.md", "a.csv", "kept/", "kept/a.csv"};
    content.others_stay = true;
    content.kept = "kept";
    content.inputs = inputs;
    return std::make_unique<OutputFolder>(out_, content);
  }
  std::string refusal(const std::vector<NamedFile>& inputs = {}) const {
    return test::message_of([&] { open(inputs); });
  }
  static void add_all(OutputFolder& folder) {
    folder.add("a.csv", "1");
    folder.add("doc.md", "ours");
  }

  test::ScratchFolder scratch_;
  fs::path out_ = scratch_.path() / "parent" / "out";
};

TEST_F(OutputFolderTest, RefusesAFolderThatTakesNoEntries) {
  out_ = "/proc/self/fd";
  EXPECT_EQ(refusal(), "folder '/proc/self/fd': cannot be written to: No such file or directory");
}

TEST_F(OutputFolderTest, ReplacesItsFilesAndLeavesOthersAndWhatIsKept) {
  test::write_file(out_ / "run", "script");
  test::write_file(out_ / "kept/note", "mine");
  for (const std::string earlier : {"ours, old", "ours, older"}) {
    test::write_file(out_ / "doc.md", earlier);
    test::write_file(out_ / "a.csv", "old");
    const auto folder = open();
    add_all(*folder);
    EXPECT_EQ(test::read_file(out_ / "doc.md"), earlier);
    folder->commit();
    EXPECT_EQ(test::read_file(out_ / "doc.md"), "ours");
    EXPECT_EQ(test::read_file(out_ / "a.csv"), "1");
    EXPECT_EQ(test::read_file(out_ / "run"), "script");
    EXPECT_EQ(test::read_file(out_ / "kept/note"), "mine");
    EXPECT_FALSE(fs::exists(out_ / ".partial"));
  }
}

TEST_F(OutputFolderTest, RefusesFilesThatAnotherProgramHasWritten) {
  test::write_file(out_ / "a.csv", "mine");
  EXPECT_EQ(refusal(),
            "folder '" + out_.string() +
                "': holds 'a.csv' but no doc.md that is a document of this test: must be moved away");
  EXPECT_EQ(test::read_file(out_ / "a.csv"), "mine");
  fs::remove(out_ / "a.csv");
  test::write_file(out_ / "doc.md", "mine");
  EXPECT_THAT(refusal(), HasSubstr("holds 'doc.md' but no doc.md that is a document of this test"));
  test::write_file(out_ / "doc.md", "ours");
  fs::create_directory(out_ / "a.csv");
  EXPECT_THAT(refusal(), HasSubstr("holds 'a.csv': must be moved away"));
}

TEST_F(OutputFolderTest, RefusesAnInputThatItWouldReplace) {
  test::write_file(out_ / "doc.md", "ours");
  test::write_file(out_ / "a.csv", "table");
  fs::create_symlink(out_ / "a.csv", scratch_.path() / "link");
  for (const fs::path& input : {out_ / "a.csv", scratch_.path() / "link"}) {
    EXPECT_THAT(refusal({{"--left", input}}),
                HasSubstr("out': --left '" + input.string() +
                          "' lies in it and would be replaced: an input must lie elsewhere"));
  }
  for (const char* other : {"other", "kept/a.csv"})
    EXPECT_NO_THROW(open({{"--left", test::write_file(out_ / other, "mine")}})) << other;
}

// A file that has appeared since the object was made is not replaced, and no file has changed.
TEST_F(OutputFolderTest, RefusesAtTheCommitWhatHasAppearedUnderItsNames) {
  for (const std::string name : {"a.csv", "doc.md"}) {
    const std::string earlier = name == "a.csv" ? "doc.md" : "";
    if (!earlier.empty()) test::write_file(out_ / earlier, "ours, old");
    auto folder = open();
    add_all(*folder);
    test::write_file(out_ / name, "mine");
    EXPECT_THAT(test::message_of([&] { folder->commit(); }),
                HasSubstr("the new files cannot be moved into place: " + name + ": File exists"));
    folder.reset();
    EXPECT_EQ(test::read_file(out_ / name), "mine");
    if (!earlier.empty()) {
      EXPECT_EQ(test::read_file(out_ / earlier), "ours, old");
    }
    EXPECT_FALSE(fs::exists(out_ / ".partial"));
    EXPECT_EQ(std::distance(fs::directory_iterator(out_), {}), earlier.empty() ? 1 : 2);
    fs::remove_all(out_);
  }
}

// A user's file that takes the name of a new file between a kill and the next run stops the repair.
TEST_F(OutputFolderTest, RepairsNothingOverAFileOfTheUser) {
  test::write_file(out_ / ".partial/complete/a.csv", "1");
  test::write_file(out_ / ".partial/complete/doc.md", "ours");
  test::write_file(out_ / "a.csv", "mine");
  EXPECT_THAT(refusal(), HasSubstr("cannot be written to: a.csv: File exists"));
  EXPECT_EQ(test::read_file(out_ / "a.csv"), "mine");
  fs::remove(out_ / "a.csv");
  open();
  EXPECT_EQ(test::read_file(out_ / "a.csv"), "1");
}

}  // namespace
}  // namespace stereotlm::files
