#include "sw/files/shell_word.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "sw/process/command.h"

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

}  // namespace
}  // namespace stereotlm::files
