#include "sw/files/document_folder.h"

#include <gmock/gmock.h>

#include <stdexcept>

#include "tests/support/scratch_folder.h"

namespace stereotlm::files {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const std::map<std::string, std::string> kContents = {{"a.csv", "1"}, {"a.png", "2"}, {"doc.md", "3"}};

class DocumentFolderTest : public testing::Test {
 protected:
  std::string refusal() const {
    return test::message_of([&] { const DocumentFolder folder(out_, "doc.md", {"a.csv", "a.png"}); });
  }
  void write() const { DocumentFolder(out_, "doc.md", {"a.csv", "a.png"}).commit(kContents); }

  test::ScratchFolder scratch_;
  fs::path out_ = scratch_.path() / "parent" / "out";
};

TEST_F(DocumentFolderTest, CreatesTheFolderAndItsParents) {
  write();
  for (const auto& [name, bytes] : kContents) EXPECT_EQ(test::read_file(out_ / name), bytes);
  EXPECT_FALSE(fs::exists(out_ / ".partial"));
}

TEST_F(DocumentFolderTest, LeavesNothingBehindWithoutACommit) {
  { const DocumentFolder folder(out_ / "", "doc.md", {"a.csv", "a.png"}); }
  EXPECT_FALSE(fs::exists(out_.parent_path()));
}

TEST_F(DocumentFolderTest, KeepsAnEarlierResultWithoutACommit) {
  write();
  { const DocumentFolder folder(out_, "doc.md", {"a.csv", "a.png"}); }
  EXPECT_EQ(test::read_file(out_ / "a.csv"), "1");
  EXPECT_FALSE(fs::exists(out_ / ".partial"));
}

TEST_F(DocumentFolderTest, ReplacesAnEarlierResultAndLeavesOtherFiles) {
  test::write_file(out_ / "run", "script");
  test::write_file(out_ / "doc.md", "old");
  test::write_file(out_ / "a.csv", "old");
  write();
  EXPECT_EQ(test::read_file(out_ / "run"), "script");
  EXPECT_EQ(test::read_file(out_ / "doc.md"), "3");
  EXPECT_EQ(test::read_file(out_ / "a.csv"), "1");
}

TEST_F(DocumentFolderTest, RefusesAFileOfItsNameThatIsSomebodyElses) {
  test::write_file(out_ / "a.csv", "mine");
  EXPECT_THAT(refusal(),
              HasSubstr("out': holds 'a.csv' but no doc.md: only what an earlier one has written"));
  EXPECT_EQ(test::read_file(out_ / "a.csv"), "mine");
}

TEST_F(DocumentFolderTest, RefusesWhatIsNoFile) {
  test::write_file(out_ / "doc.md", "old");
  fs::create_directory(out_ / "a.png");
  EXPECT_THAT(refusal(), HasSubstr("holds 'a.png', which is no file"));
}

TEST_F(DocumentFolderTest, RefusesAFileInItsPlace) {
  test::write_file(out_, "");
  EXPECT_THAT(refusal(), HasSubstr("out': not a folder"));
}

TEST_F(DocumentFolderTest, CleansAwayWhatAKilledOneHasLeft) {
  test::write_file(out_ / ".partial/new/a.csv", "half");
  test::write_file(out_ / "a.csv", "old, but for its document");
  write();
  EXPECT_EQ(test::read_file(out_ / "a.csv"), "1");
  EXPECT_FALSE(fs::exists(out_ / ".partial"));
}

TEST_F(DocumentFolderTest, RefusesASecondRunIntoTheFolder) {
  {
    DocumentFolder first(out_, "doc.md", {"a.csv", "a.png"});
    EXPECT_EQ(refusal(), "folder '" + out_.string() + "': in use by another run");
    first.commit(kContents);
  }
  EXPECT_EQ(test::read_file(out_ / "a.csv"), "1");
  EXPECT_NO_THROW(write());
}

TEST_F(DocumentFolderTest, WritesNothingWhereSomethingOfItsNamesHasComeMeanwhile) {
  test::write_file(out_ / "doc.md", "old");
  {
    DocumentFolder folder(out_, "doc.md", {"a.csv", "a.png"});
    fs::create_directory(out_ / "a.png");
    EXPECT_THAT(test::message_of([&] { folder.commit(kContents); }),
                HasSubstr("holds 'a.png', which is no file"));
  }
  EXPECT_EQ(test::read_file(out_ / "doc.md"), "old");
  EXPECT_FALSE(fs::exists(out_ / "a.csv"));
  EXPECT_FALSE(fs::exists(out_ / ".partial"));
  fs::remove(out_ / "a.png");
  fs::remove(out_ / "doc.md");
  {
    DocumentFolder folder(out_, "doc.md", {"a.csv", "a.png"});
    test::write_file(out_ / "a.csv", "mine");
    EXPECT_THAT(test::message_of([&] { folder.commit(kContents); }),
                HasSubstr("holds 'a.csv' but no doc.md"));
  }
  EXPECT_EQ(test::read_file(out_ / "a.csv"), "mine");
}

TEST_F(DocumentFolderTest, RefusesAPartialFolderOfSomebodyElse) {
  test::write_file(out_ / ".partial" / "thesis.tex", "");
  EXPECT_THAT(refusal(), HasSubstr("holds '.partial/thesis.tex'"));
  fs::remove_all(out_ / ".partial");
  test::write_file(out_ / ".partial", "");
  EXPECT_THAT(refusal(), HasSubstr("holds '.partial', which is no folder"));
}

TEST_F(DocumentFolderTest, CommitsAllFilesAndNoOthers) {
  DocumentFolder folder(out_, "doc.md", {"a.csv", "a.png"});
  EXPECT_THROW(folder.commit({{"doc.md", ""}, {"a.csv", ""}}), std::invalid_argument);
  auto more = kContents;
  more["b.csv"] = "";
  EXPECT_THROW(folder.commit(more), std::invalid_argument);
}

TEST_F(DocumentFolderTest, RefusesAnEmptyName) {
  EXPECT_THROW(DocumentFolder("", "doc.md", {}), std::runtime_error);
}

}  // namespace
}  // namespace stereotlm::files
