#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "platform/config/board_yaml.h"

namespace stereotlm::process {

// Pixels of 8 bits that a client and a command exchange beside the text.
struct Array {
  std::string name;                  // "left"
  std::vector<std::uint64_t> shape;  // {rows, columns}, or {pictures, rows, columns}
  std::string bytes;                 // row by row
};

// Takes the place of the terminal for a command that a worker executes: `stereotlm worker`.
class Client {
 public:
  virtual ~Client() = default;

  // The array that came with the command; nullptr if there is none of this name. A command asks for all that
  // it takes while its options are checked.
  virtual const Array* given(std::string_view name) = 0;
  // Throws Refused if there is an array for which the command has not asked.
  virtual void check_given() const = 0;

  virtual void print(std::string_view text) = 0;  // what goes to standard output elsewhere
  virtual void say(const std::string& line) = 0;  // a line for standard error
  virtual void send(const Array& array) = 0;
  // `done` of `of` pieces of work are done; `text` is the progress line.
  virtual void progress(std::uint64_t done, std::uint64_t of, const std::string& text) = 0;
  // Why the command is refused.
  virtual void refuse(const std::vector<platform::Diagnostic>& problems) = 0;
};

// Null unless this process executes a command for a client.
inline Client* client = nullptr;

// Contents of input files by their names.
using FileContents = std::map<std::string, std::string>;

// Those of a board, and of `names`, that the client has sent, so that the files are not read.
inline FileContents sent_files(std::vector<std::string> names = {}) {
  FileContents sent;
  names.insert(names.end(),
               {"board.yaml", "calibration.yaml", "calibration_left.lut", "calibration_right.lut"});
  for (const std::string& name : names) {
    const Array* const array = client == nullptr ? nullptr : client->given(name);
    if (array != nullptr) sent[name] = array->bytes;
  }
  return sent;
}

}  // namespace stereotlm::process
