#include "sw/files/aside.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "sw/files/text_forms.h"
#include "sw/files/whole_file.h"

namespace stereotlm::files {

namespace fs = std::filesystem;

Remover::Remover(const std::string& script, const std::vector<std::string>& words, int lock) {
  // read fails at the end of the pipe. If the locked file is removed already, another process may have made a
  // new one with its name.
  const std::string command = fmt::format(
      "trap '' HUP INT QUIT TERM; exec /usr/bin/setsid /bin/sh -c {} stereotlm-remover {} >/dev/null 2>&1",
      shell_word(fmt::format("read -r _ || {{ is_ours() {{ [ /proc/self/fd/{} -ef \"$1\" ]; }}; {}; }}", lock,
                             script)),
      shell_command(words));
  fcntl(lock, F_SETFD, 0);  // the shell inherits it
  shell_ = popen(command.c_str(), "we");
  const int error = errno;
  fcntl(lock, F_SETFD, FD_CLOEXEC);
  if (shell_ == nullptr) fail(error, "/bin/sh");
}

Remover::~Remover() {
  std::fputs("\n", shell_);
  pclose(shell_);
}

NewFile::NewFile(const fs::path& path)
    : path_(path), descriptor_(open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666)) {
  if (descriptor_ < 0) fail(errno, path_);
}

NewFile::~NewFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void NewFile::write(std::string_view bytes) {
  constexpr std::size_t kBufferBytes = std::size_t{1} << 18U;
  buffer_.append(bytes);
  if (buffer_.size() >= kBufferBytes) flush();
}

void NewFile::flush() {
  for (std::string_view bytes = buffer_; !bytes.empty();) {
    const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) fail(count < 0 ? errno : ENOSPC, path_);
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  buffer_.clear();
}

void NewFile::close() {
  flush();
  if (::close(std::exchange(descriptor_, -1)) != 0 && errno != EINTR) fail(errno, path_);
  sync(path_);
}

void write_whole_file(const fs::path& path, std::string_view bytes) {
  NewFile file(path);
  file.write(bytes);
  file.close();
}

Aside::Aside(const fs::path& path, const std::function<void(const fs::path& entry)>& check) : path_(path) {
  constexpr int kMostTries = 100;  // the Remover of a killed process ends within a second
  try {
    for (int tries = 1; const int error = try_lock(); ++tries) {
      if ((error != EBUSY && error != ENOENT) || tries == kMostTries) fail(error, path_);
      usleep(10'000);
    }
    for (const fs::path& name : entries(path_)) check(path_ / name);
    std::vector<std::string> words = {path_};
    words.insert(words.end(), made_.rbegin(), made_.rend());
    // A process that is killed together with this one may still write for a moment.
    remover_.emplace(
        "[ -e \"$1/earlier\" ] || { for i in 1 2 3 4 5 6 7 8 9; do is_ours \"$1\" || break; "
        "/bin/rm -rf -- \"$1\" && break; sleep 0.1; done; shift; /bin/rmdir -- \"$@\"; }",
        words, lock_);
  } catch (...) {
    std::error_code ignored;
    if (lock_ >= 0) fs::remove(path_, ignored);
    remove_if_empty();
    throw;
  }
}

// Returns 0 or an error: EBUSY if another process has the lock, ENOENT if another process has removed a
// folder before it was locked.
int Aside::try_lock() {
  std::vector<fs::path> missing;
  for (fs::path path = path_.parent_path(); !is_there(path); path = path.parent_path())
    missing.push_back(path);
  for (auto path = missing.rbegin(); path != missing.rend(); ++path) {
    if (fs::create_directory(*path)) made_.push_back(*path);
  }
  const bool is_new = mkdir(path_.c_str(), 0777) == 0;
  if (!is_new && errno != EEXIST) return errno;
  const int folder = open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (folder < 0) {
    const int error = errno;
    if (is_new) rmdir(path_.c_str());
    return error;
  }
  // A file system without locks fails with another error, and is used without them.
  const bool is_held = flock(folder, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  if (!is_held && is_open_at(folder, path_)) {
    lock_ = folder;
    return 0;
  }
  close(folder);
  return is_held ? EBUSY : ENOENT;
}

// Removes the parents, and ends the lock.
void Aside::remove_if_empty() noexcept {
  std::error_code ignored;
  for (auto path = made_.rbegin(); path != made_.rend(); ++path) fs::remove(*path, ignored);
  if (lock_ >= 0) close(lock_);
}

Aside::~Aside() {
  std::error_code ignored;
  if (!is_there(path_ / "earlier")) fs::remove_all(path_, ignored);
  remove_if_empty();  // before the Remover ends, so that a kill leaves no empty parent
}

TemporaryFolder::TemporaryFolder() {
  std::string variable = "TMPDIR";
  std::string folder = "/tmp";
  for (const char* name : {"TEMPDIR", "TEMP", "TMP", "TMPDIR"}) {  // the last counts
    const char* const value = std::getenv(name);
    if (value != nullptr && *value != '\0') std::tie(variable, folder) = std::pair(name, value);
  }
  const auto refuse = [&](const std::string& rule) {
    throw std::runtime_error(fmt::format("{} = {}: {}", variable, folder, rule));
  };
  std::error_code error;
  if (!fs::is_directory(folder, error)) refuse("must be a folder");
  std::string path = (fs::path(folder) / "stereotlm_XXXXXX").string();
  if (mkdtemp(path.data()) == nullptr)
    refuse(fmt::format("must be a folder that takes temporary files: {}", std::strerror(errno)));
  try {
    aside_.emplace(fs::absolute(path), [](const fs::path& /*entry*/) {});
  } catch (...) {  // such as too many open files
    rmdir(path.c_str());
    throw;
  }
}

}  // namespace stereotlm::files
