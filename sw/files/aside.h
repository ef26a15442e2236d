#pragma once

#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stereotlm::files {

// Removes files if this process ends before the object is destroyed, even if it is killed. A shell waits for
// that end. It has a session of its own, so that the signals of a terminal do not reach it.
class Remover {
 public:
  // `script`: what the shell then executes, with the words as $1, $2 and so on. `lock`: the descriptor of a
  // locked file, whose lock the shell keeps until it has ended. Throws std::system_error if the shell cannot
  // be started.
  Remover(const std::string& script, const std::vector<std::string>& words, int lock);
  ~Remover();  // ends the shell, which removes nothing
  Remover(const Remover&) = delete;
  Remover& operator=(const Remover&) = delete;

 private:
  std::FILE* shell_;  // a pipe to it, which the system closes with this process
};

// A new file, written piece by piece. All functions throw std::system_error if a byte cannot be stored.
class NewFile {
 public:
  explicit NewFile(const std::filesystem::path& path);  // throws also if the file exists
  ~NewFile();
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  void write(std::string_view bytes);
  void close();  // makes the file durable; no write() may follow

 private:
  void flush();

  std::filesystem::path path_;
  int descriptor_;
  std::string buffer_;
};

// Writes a new file and makes it durable. Throws std::system_error if it exists or cannot be stored.
void write_whole_file(const std::filesystem::path& path, std::string_view bytes);

// A folder for unfinished files, which one process has at a time. The destructor removes it with all that it
// holds, and the parents that the constructor has made, if they are empty. The end of this process does the
// same, whatever ends it. The folder stays while it holds an entry `earlier`: see OutputFolder::commit().
class Aside {
 public:
  // Makes the folder and its missing parents, or takes the one that a killed process has left. `check` throws
  // if an entry of that one is not what such a process leaves; the folder then stays. Throws
  // std::system_error: with EBUSY if another process has the folder.
  Aside(const std::filesystem::path& path,
        const std::function<void(const std::filesystem::path& entry)>& check);
  ~Aside();
  Aside(const Aside&) = delete;
  Aside& operator=(const Aside&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  int try_lock();
  void remove_if_empty() noexcept;

  std::filesystem::path path_;
  std::vector<std::filesystem::path> made_;  // parents, outermost first
  int lock_ = -1;                            // descriptor of the folder
  std::optional<Remover> remover_;
};

// A new folder for temporary files, in the folder that the first of the environment variables TMPDIR, TMP,
// TEMP and TEMPDIR names that is set; if none is set, in /tmp. The destructor and the end of this process
// remove it.
class TemporaryFolder {
 public:
  TemporaryFolder();  // throws std::runtime_error with the place if it cannot be made
  const std::filesystem::path& path() const { return aside_->path(); }

 private:
  std::optional<Aside> aside_;
};

}  // namespace stereotlm::files
