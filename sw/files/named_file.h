#pragma once

#include <string>

namespace stereotlm::files {

// A file that an option or an argument of a command names, directly or by its folder.
struct NamedFile {
  std::string option;
  std::string path;

  std::string text() const { return option + " '" + path + "'"; }
};

}  // namespace stereotlm::files
