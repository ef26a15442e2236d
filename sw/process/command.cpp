#include "sw/process/command.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "models/fpga/core_config.h"
#include "sw/process/child.h"
#include "sw/process/streams.h"

namespace stereotlm::process {
namespace {

// OpenCV reads variables of the environment when it is loaded, and an unreadable value ends the process. Only
// the variables that are set here remain, so that results do not depend on the environment.
void set_up_opencv() {
  const std::string beginning = "OPENCV_";
  std::vector<std::string> names;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const std::string text = *variable;
    if (text.rfind(beginning, 0) == 0) names.push_back(text.substr(0, text.find('=')));
  }
  for (const std::string& name : names) unsetenv(name.c_str());
  // OpenCV refuses a larger picture before it decodes the pixels.
  setenv("OPENCV_IO_MAX_IMAGE_WIDTH", std::to_string(fpga::kWidthRule.max).c_str(), 1);
  setenv("OPENCV_IO_MAX_IMAGE_HEIGHT", std::to_string(fpga::kHeightRule.max).c_str(), 1);
}

[[noreturn]] void fail(int error, const char* what) {
  throw std::system_error(error, std::generic_category(), what);
}

class MemoryFile {
 public:
  MemoryFile() : descriptor_(memfd_create("output", MFD_CLOEXEC)) {
    if (descriptor_ < 0) fail(errno, "memfd_create");
  }
  ~MemoryFile() { close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  int descriptor() const { return descriptor_; }
  std::string text() const {
    std::string text(static_cast<std::size_t>(std::max<off_t>(lseek(descriptor_, 0, SEEK_END), 0)), '\0');
    const ssize_t count = pread(descriptor_, text.data(), text.size(), 0);
    text.resize(static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
    return text;
  }

 private:
  int descriptor_;
};

// Becomes the program, in a forked process. Returns if that fails.
void become(char* const* arguments, char* const* variables, int out, int errors) {
  setpgid(0, 0);
  dup2(open("/dev/null", O_RDONLY | O_CLOEXEC), STDIN_FILENO);
  dup2(out, STDOUT_FILENO);
  dup2(errors, STDERR_FILENO);
  // Ignored in this process.
  for (const int ended_by : {SIGPIPE, SIGXFSZ}) signal(ended_by, SIG_DFL);
  execvpe(arguments[0], arguments, variables);
}

std::vector<char*> shown_variables(const std::vector<std::string>& hidden) {
  std::vector<char*> shown;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const std::string text = *variable;
    const auto begins = [&text](const std::string& name) { return text.compare(0, name.size(), name) == 0; };
    if (std::none_of(hidden.begin(), hidden.end(), begins)) shown.push_back(*variable);
  }
  shown.push_back(nullptr);
  return shown;
}

// The path of a file that is installed with the program. `from_program`: its path relative to the folder of
// the program.
std::filesystem::path installed_path(const std::string& from_program) {
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe");
  return (program.parent_path() / from_program).lexically_normal();
}

}  // namespace

const void* plugin_symbol(const std::string& library_name, const char* symbol, const std::string& what) {
  const std::string path = installed_path(STEREOTLM_PLUGIN_FOLDER) / library_name;
  set_up_opencv();
  void* const library = dlopen(path.c_str(), RTLD_LAZY | RTLD_LOCAL);
  const void* const found = library == nullptr ? nullptr : dlsym(library, symbol);
  if (found == nullptr) {
    throw std::runtime_error("the library that " + what + " cannot be loaded: " + dlerror());
  }
  return found;
}

CommandEnd run_command(const std::vector<std::string>& words, const std::vector<std::string>& hidden,
                       const std::function<void()>& waiting) {
  const MemoryFile out;
  const MemoryFile errors;
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  const std::vector<char*> variables = shown_variables(hidden);
  Pipe failure;  // the program closes it when it begins
  const pid_t pid = fork_bound();
  if (pid == 0) {
    become(arguments.data(), variables.data(), out.descriptor(), errors.descriptor());
    write_all(failure.write_end(), &errno, sizeof errno);
    _exit(1);
  }
  failure.close_write_end();
  int error = 0;
  if (read_all(failure.read_end(), &error, sizeof error)) waitpid(pid, nullptr, 0);
  if (error == ENOENT) throw CommandMissing(words[0] + ": not found in PATH");
  if (error != 0) fail(error, words[0].c_str());
  int status = 0;
  for (pid_t ended = 0; ended != pid;) {
    ended = waitpid(pid, &status, waiting ? WNOHANG : 0);
    if (ended < 0 && errno != EINTR) fail(errno, "waitpid");
    if (ended != 0) continue;
    if (interrupted()) kill(pid, SIGTERM);
    waiting();
    usleep(10'000);
  }
  constexpr int kSignalled = 128;
  return {WIFSIGNALED(status) ? kSignalled + WTERMSIG(status) : WEXITSTATUS(status), out.text(),
          errors.text()};
}

CommandEnd run_script(const std::string& script, const std::vector<std::string>& arguments,
                      const std::string& python, const std::function<void()>& waiting) {
  const std::string path = installed_path(STEREOTLM_SCRIPT_FOLDER) / script;
  if (!std::filesystem::is_regular_file(path))
    throw std::runtime_error(fmt::format("'{}': not found: it is installed with the program", path));
  // -E and -s: variables of the environment (PYTHON..) and packages of the user have no effect. -B: Python
  // writes no file beside the script.
  std::vector<std::string> words = {python, "-E", "-s", "-B", path};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::string cause;
  try {
    return run_command(words, {}, waiting);
  } catch (const CommandMissing& /*error*/) {
    cause = std::strerror(ENOENT);
  } catch (const std::system_error& error) {
    cause = error.code().message();
  }
  throw std::runtime_error(
      fmt::format("'{}', which draws the figures: cannot be started: {}", python, cause));
}

void become_python(const std::string& module, const std::vector<std::string>& arguments,
                   const std::string& page) {
  const std::filesystem::path folder = installed_path(STEREOTLM_MODULE_FOLDER);
  if (!std::filesystem::is_directory(folder / "stereotlm"))
    throw std::runtime_error(
        fmt::format("'{}': the Python module is not installed: the package python3-stereotlm has it",
                    (folder / "stereotlm").string()));
  const int descriptor = memfd_create("page", 0);  // the program inherits it
  if (descriptor < 0) fail(errno, "memfd_create");
  if (!write_all(descriptor, page.data(), page.size())) fail(errno, "write");
  std::vector<std::string> words = {
      kPython,
      "-E",
      "-s",
      "-B",
      "-c",
      fmt::format("import sys; sys.path.insert(0, sys.argv.pop(1)); from {} import main; main()", module),
      folder.string(),
      "--page",
      std::to_string(descriptor),
      "--program=" + std::filesystem::read_symlink("/proc/self/exe").string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  execv(kPython, pointers.data());
  fail(errno, kPython);
}

}  // namespace stereotlm::process
