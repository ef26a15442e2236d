#pragma once

#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sw/files/remover.h"

namespace stereotlm::files {

// Throws std::system_error with this error of the system and the path.
[[noreturn]] void fail(int error, const std::filesystem::path& path);

// A new file that is written piece by piece. All functions throw std::system_error with the cause as code if
// a byte cannot be stored. The caller then removes the file.
class NewFile {
 public:
  // Throws also if the file exists.
  explicit NewFile(const std::filesystem::path& path);
  ~NewFile();
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  void write(std::string_view bytes);
  int descriptor() const { return descriptor_; }
  // Makes the file durable, and closes it. No write() may follow.
  void close();

 private:
  std::filesystem::path path_;
  int descriptor_;
};

// Writes a new file and makes it durable. Throws std::system_error with the cause as code if the file exists
// or a byte cannot be stored. The caller then removes the file.
void write_whole_file(const std::filesystem::path& path, std::string_view bytes);

// Throws std::runtime_error "'PATH': cause" if there is no regular file.
void check_regular_file(const std::filesystem::path& path);

// Reads the whole content. Throws std::runtime_error with path and cause if it is no readable regular file. A
// file longer than `most_bytes` is refused before it is read.
std::string read_whole_file(const std::filesystem::path& path,
                            std::uintmax_t most_bytes = std::numeric_limits<std::uintmax_t>::max());

// Makes the entries of a folder durable. Throws std::system_error.
void sync_folder(const std::filesystem::path& folder);

// Names of the entries of a folder, sorted. Throws std::filesystem::filesystem_error.
std::vector<std::filesystem::path> entries(const std::filesystem::path& folder);

// Whether the open file is the one at `path`, which is not a symbolic link.
bool is_open_at(int file, const std::filesystem::path& path);

// Whether an entry exists, is a regular file, is a folder. A symbolic link exists, but is neither of the two.
bool is_there(const std::filesystem::path& path);
bool is_file(const std::filesystem::path& path);
bool is_folder(const std::filesystem::path& path);

// A new folder for temporary files, in the folder that the first of the environment variables TMPDIR, TMP,
// TEMP and TEMPDIR names that is set; if none is set, in /tmp. The destructor removes it, and so does the end
// of this process.
class TemporaryFolder {
 public:
  TemporaryFolder();  // throws std::runtime_error with the place if it cannot be created
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  std::optional<Remover> remover_;
};

}  // namespace stereotlm::files
