#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace stereotlm::process {

// There is no such program.
class CommandMissing : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// What a program has said, and how it has ended.
struct CommandEnd {
  int status = 0;  // of its exit; 128 + number of the signal that has ended it
  std::string out;
  std::string errors;
};

// Runs words[0], found in PATH, with these words, and waits for its end. No shell reads them. It has nothing
// to read, the environment of this process but for variables that begin with one of `hidden`, and is not
// reached by a terminal's Ctrl-C. Throws CommandMissing, std::system_error.
CommandEnd run_command(const std::vector<std::string>& words, const std::vector<std::string>& hidden = {});

}  // namespace stereotlm::process
