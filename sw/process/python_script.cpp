#include "sw/process/python_script.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <system_error>

#include "sw/process/installation.h"

namespace stereotlm::process {
namespace {

// The words of the command that runs a script. Throws std::runtime_error if the script does not exist.
std::vector<std::string> words_of(const std::string& script, const std::vector<std::string>& arguments,
                                  const std::string& python) {
  const std::string path = installed_path(STEREOTLM_SCRIPT_FOLDER) / script;
  if (!std::filesystem::is_regular_file(path)) {
    throw std::runtime_error(fmt::format("'{}': not found: it is installed with the program", path));
  }
  // -E and -s: variables of the environment (PYTHON..) and packages of the user have no effect. -B: Python
  // writes no file beside the script.
  std::vector<std::string> words = {python, "-E", "-s", "-B", path};
  words.insert(words.end(), arguments.begin(), arguments.end());
  return words;
}

}  // namespace

CommandEnd run_script(const std::string& script, const std::vector<std::string>& arguments,
                      const std::string& python) {
  const std::vector<std::string> words = words_of(script, arguments, python);
  const auto fail = [&python](const std::string& cause) {
    throw std::runtime_error(
        fmt::format("'{}', which draws the figures: cannot be started: {}", python, cause));
  };
  try {
    return run_command(words, {}, true);
  } catch (const CommandMissing& /*error*/) {
    fail(std::strerror(ENOENT));
  } catch (const std::system_error& error) {
    fail(error.code().message());
  }
  return {};
}

}  // namespace stereotlm::process
