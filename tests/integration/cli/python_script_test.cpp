#include "sw/cli/python_script.h"

#include <gmock/gmock.h>

#include <stdexcept>

namespace stereotlm::cli {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(PythonScript, SaysThatPythonIsMissing) {
  EXPECT_THAT([] { become_script("plot_all.py", {}, "/nowhere/python3"); },
              ThrowsMessage<std::runtime_error>(
                  HasSubstr("'/nowhere/python3', which draws the figures: cannot be started: No such file")));
}

TEST(PythonScript, SaysThatTheScriptIsMissing) {
  EXPECT_THAT([] { become_script("plot_nothing.py", {}); },
              ThrowsMessage<std::runtime_error>(HasSubstr("/plots/plot_nothing.py': not found")));
}

TEST(PythonScript, SaysSoToWhoeverWaitsForItsEndToo) {
  EXPECT_THAT([] { run_script("plot_paper.py", {}, "/nowhere/python3"); },
              ThrowsMessage<std::runtime_error>(
                  HasSubstr("'/nowhere/python3', which draws the figures: cannot be started: No such file")));
  EXPECT_THAT([] { run_script("plot_nothing.py", {}); },
              ThrowsMessage<std::runtime_error>(HasSubstr("/plots/plot_nothing.py': not found")));
}

TEST(PythonScript, TellsHowAScriptHasEnded) {
  const auto end = run_script("plot_paper.py", {"--out=/nowhere", "--", "/nowhere"});
  EXPECT_EQ(end.status, 1);
  EXPECT_THAT(end.errors, HasSubstr("/nowhere/table1.csv"));
}

}  // namespace
}  // namespace stereotlm::cli
