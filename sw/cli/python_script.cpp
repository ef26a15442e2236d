#include "sw/cli/python_script.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include "sw/cli/installed_path.h"

namespace stereotlm::cli {

void become_script(const std::string& script, const std::vector<std::string>& arguments,
                   const std::string& python) {
  const std::string path = installed_path(STEREOTLM_SCRIPT_FOLDER) / script;
  if (!std::filesystem::is_regular_file(path)) {
    throw std::runtime_error(fmt::format("'{}': not found: it is installed with the program", path));
  }
  // -B: writes nothing beside the script.
  std::vector<std::string> words = {python, "-B", path};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  execv(python.c_str(), pointers.data());
  throw std::runtime_error(
      fmt::format("'{}', which draws the figures: cannot be started: {}", python, std::strerror(errno)));
}

}  // namespace stereotlm::cli
