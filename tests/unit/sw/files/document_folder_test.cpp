#include "sw/files/document_folder.h"

#include <gmock/gmock.h>

#include <stdexcept>

#include "tests/support/scratch_folder.h"

namespace stereotlm::files {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const std::map<std::string, std::string> kContents = {{"a.csv", "1"}, {"a.png", "2"}, {"doc.md", "ours"}};
const FileKind kDocumentKind = marked_kind("document of this test", {{0, "ours"}});

class DocumentFolderTest : public testing::Test {
 protected:
  std::string refusal() const {
    return test::message_of([&] {
      const DocumentFolder folder(out_, "doc.md", kDocumentKind, {"a.csv", "a.png"});
    });
  }
  void write() const { DocumentFolder(out_, "doc.md", kDocumentKind, {"a.csv", "a.png"}).commit(kContents); }

  test::ScratchFolder scratch_;
  fs::path out_ = scratch_.path() / "parent" / "out";
};

TEST_F(DocumentFolderTest, WritesAndReplacesItsFilesAndLeavesOthers) {
  write();
  test::write_file(out_ / "run", "script");
  test::write_file(out_ / "doc.md", "ours, old");
  test::write_file(out_ / "a.csv", "old");
  write();
  for (const auto& [name, bytes] : kContents) EXPECT_EQ(test::read_file(out_ / name), bytes);
  EXPECT_EQ(test::read_file(out_ / "run"), "script");
}

TEST_F(DocumentFolderTest, RefusesAFileThatAnotherProgramHasWritten) {
  test::write_file(out_ / "a.csv", "mine");
  EXPECT_THAT(
      refusal(),
      HasSubstr("out': holds 'a.csv' but no doc.md that is a document of this test: only files of an earlier "
                "result are replaced"));
  EXPECT_EQ(test::read_file(out_ / "a.csv"), "mine");
  fs::remove(out_ / "a.csv");
  test::write_file(out_ / "doc.md", "mine");
  EXPECT_THAT(refusal(), HasSubstr("out': holds 'doc.md' but no doc.md that is a document of this test"));
}

TEST_F(DocumentFolderTest, RefusesAnInputThatItWouldReplace) {
  test::write_file(out_ / "doc.md", "ours");
  test::write_file(out_ / "a.png", "picture");
  test::write_file(out_ / "other.png", "picture");
  fs::create_symlink(out_ / "a.png", scratch_.path() / "link.png");
  for (const fs::path& input : {out_ / "a.png", scratch_.path() / "link.png", out_ / "other.png"}) {
    const auto open = [&] {
      const DocumentFolder folder(out_, "doc.md", kDocumentKind, {"a.png"}, {{"--left", input}});
    };
    if (input.filename() == "other.png") {
      EXPECT_NO_THROW(open());
    } else {
      EXPECT_THAT(test::message_of(open),
                  HasSubstr("out': --left '" + input.string() +
                            "' lies in it and would be replaced: an input must lie elsewhere"));
    }
  }
}

TEST_F(DocumentFolderTest, RefusesAFolderOfTheNameOfAFile) {
  test::write_file(out_ / "doc.md", "ours, old");
  fs::create_directory(out_ / "a.png");
  EXPECT_THAT(refusal(), HasSubstr("holds 'a.png', which is no file"));
}

TEST_F(DocumentFolderTest, RemovesTheFilesOfAKilledProcess) {
  test::write_file(out_ / ".partial/new/a.csv", "half");
  test::write_file(out_ / "a.csv", "old, but for its document");
  write();
  EXPECT_EQ(test::read_file(out_ / "a.csv"), "1");
  EXPECT_FALSE(fs::exists(out_ / ".partial"));
}

TEST_F(DocumentFolderTest, RefusesAtTheCommitWhatHasAppearedUnderItsNames) {
  test::write_file(out_ / "doc.md", "ours, old");
  {
    DocumentFolder folder(out_, "doc.md", kDocumentKind, {"a.csv", "a.png"});
    fs::create_directory(out_ / "a.png");
    EXPECT_THAT(test::message_of([&] { folder.commit(kContents); }),
                HasSubstr("the new files cannot be moved into place: a.png: File exists"));
  }
  EXPECT_EQ(test::read_file(out_ / "doc.md"), "ours, old");
  EXPECT_FALSE(fs::exists(out_ / "a.csv"));
  EXPECT_FALSE(fs::exists(out_ / ".partial"));
  fs::remove(out_ / "a.png");
  fs::remove(out_ / "doc.md");
  {
    DocumentFolder folder(out_, "doc.md", kDocumentKind, {"a.csv", "a.png"});
    test::write_file(out_ / "a.csv", "mine");
    EXPECT_THAT(test::message_of([&] { folder.commit(kContents); }), HasSubstr("a.csv: File exists"));
  }
  EXPECT_EQ(test::read_file(out_ / "a.csv"), "mine");
}

TEST_F(DocumentFolderTest, CommitsAllFilesAndNoOthers) {
  DocumentFolder folder(out_, "doc.md", kDocumentKind, {"a.csv", "a.png"});
  EXPECT_THROW(folder.commit({{"doc.md", ""}, {"a.csv", ""}}), std::invalid_argument);
  auto more = kContents;
  more["b.csv"] = "";
  EXPECT_THROW(folder.commit(more), std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::files
