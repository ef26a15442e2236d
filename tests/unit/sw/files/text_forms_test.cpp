#include "sw/files/text_forms.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "sw/process/command.h"
#include "tests/support/scratch_folder.h"

namespace stereotlm::files {
namespace {

TEST(ShellCommand, IsReadByAShellAsItsWords) {
  const std::vector<std::string> words = {"printf", "%s|",    "fpl2003", "a b", "",
                                          "it's",   "[x, y]", "$HOME",   "*",   "\"\\"};
  EXPECT_EQ(process::run_command({"sh", "-c", shell_command(words)}).out,
            "fpl2003|a b||it's|[x, y]|$HOME|*|\"\\|");
}

TEST(ShellWord, IsQuotedOnlyIfItMustBe) {
  EXPECT_EQ(shell_word("--set"), "--set");
  EXPECT_EQ(shell_word("allocation.left_lut=bank0"), "allocation.left_lut=bank0");
  EXPECT_EQ(shell_word("a b"), "'a b'");
}

using ::testing::HasSubstr;

// FIPS 180-2, appendix B.
TEST(Sha256, GivesThePublishedSums) {
  EXPECT_EQ(sha256_hex("", 0), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256_hex("abc", 3), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(Sha256, OfAFileIsThatOfItsBytes) {
  const test::ScratchFolder scratch;
  std::string bytes;
  for (int i = 0; i < 200000; ++i) bytes += static_cast<char>(i % 251);
  const std::string path = test::write_file(scratch.path() / "large", bytes);
  EXPECT_EQ(sha256_file(path), sha256_hex(bytes.data(), bytes.size()));
  EXPECT_EQ(sha256_file(test::write_file(scratch.path() / "empty", "")), sha256_hex("", 0));
}

TEST(Sha256, RefusesAFileThatCannotBeRead) {
  const test::ScratchFolder scratch;
  const std::string missing = scratch.path() / "missing";
  EXPECT_EQ(test::message_of([&] { sha256_file(missing); }),
            "'" + missing + "': cannot be read: No such file or directory");
  EXPECT_THAT(test::message_of([&] { sha256_file(scratch.path()); }), HasSubstr("Is a directory"));
}

TEST(WithoutMinusZero, HasNoSignWhereOnlyZerosAreShown) {
  for (const double number : {-0.0, -1e-14, -0.004999, 0.004999})
    EXPECT_EQ(fmt::format("{:.2f}", without_minus_zero(number, 2)), "0.00");
  for (const double number : {-0.005001, 0.005001, -7.25}) EXPECT_EQ(without_minus_zero(number, 2), number);
}

TEST(RangesText, JoinsSuccessiveNumbers) {
  EXPECT_EQ(ranges_text({0}, ","), "0");
  EXPECT_EQ(ranges_text({0, 1, 2, 3}, ","), "0-3");
  EXPECT_EQ(ranges_text({0, 3, 5, 6, 9}, ", "), "0, 3, 5-6, 9");
}

}  // namespace
}  // namespace stereotlm::files
