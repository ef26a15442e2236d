#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sw/files/whole_file.h"

namespace stereotlm::files {

// The file by which a result folder of `run` is known.
inline constexpr const char* kResultMark = "run.json";

// Why nothing may be written to the path: a result folder of `run` is above it, which holds nothing else.
// nullopt if none is. The path need not exist.
std::optional<std::string> result_folder_problem(const std::filesystem::path& path);

// A file that an option or an argument of a command names, directly or by its folder.
struct NamedFile {
  std::string option;
  std::string path;

  std::string text() const { return option + " '" + path + "'"; }
};

// Follows symbolic links to a file, which need not exist, and returns its path. Throws std::system_error.
std::filesystem::path linked_file(const std::filesystem::path& path);

// Throws std::runtime_error if the file, which need not exist, is one of `others`, also by symbolic or hard
// links. An empty path is no file.
void check_is_another(const std::filesystem::path& file, const std::vector<NamedFile>& others);

// New content for a file, in a hidden file in the same folder. The destructor removes the hidden file. If the
// process is killed, a Remover does, and the next process that writes the same file. All functions throw
// std::runtime_error with the name of the file, not of the hidden one, and the cause. The constructor also
// throws while another process writes the file.
class AsideFile {
 public:
  // `file`: not a symbolic link (see linked_file()). `name`: the file in messages.
  AsideFile(std::filesystem::path file, std::string name);
  ~AsideFile();
  AsideFile(const AsideFile&) = delete;
  AsideFile& operator=(const AsideFile&) = delete;

  void write(std::string_view bytes) {
    if (bytes.size() >= kBufferBytes) return write_through(bytes);
    buffer_.append(bytes);
    if (buffer_.size() >= kBufferBytes) flush();
  }
  // The hidden file, for a library or a program that writes the content instead of write().
  const std::filesystem::path& path() const { return path_; }
  // Makes the content durable. No write() may follow. A second call has no effect.
  void complete();
  // Renames the hidden file to the file, after complete(). Without `replaces`, an existing file is an error.
  // With `replaces`, an existing file is replaced, and the new one gets its mode and group, and its owner if
  // root runs this process. If the group cannot be changed, its own group gets the permissions of all other
  // users.
  void take_place(bool replaces);

 private:
  static constexpr std::size_t kBufferBytes = std::size_t{1} << 18U;
  void flush() { write_through({}); }
  void write_through(std::string_view bytes);

  std::filesystem::path file_;
  std::string name_;
  std::filesystem::path path_;  // empty after take_place()
  std::optional<NewFile> new_;  // nullopt after complete()
  int lock_ = -1;               // descriptor of the hidden file, which is locked while this process has it
  std::optional<Remover> remover_;
  std::string buffer_;
};

// A kind of file that a command writes.
struct FileKind {
  std::string called;  // in messages: "page of stereotlm report"
  // Whether this program has written the file, which exists and is not empty. Must not be true by chance.
  std::function<bool(const std::filesystem::path& file)> is_own;
  // Endings of files that would change what a reader sees in a new file: "-wal" of a database.
  std::vector<std::string> journals = {};
};

// A kind whose files have these bytes at these places. No other program writes them there.
FileKind marked_kind(std::string called, std::vector<std::pair<std::size_t, std::string>> marks);

// A single file that a command writes, as a whole: commit() puts the new content in place, and until then an
// earlier file is unchanged. A symbolic link stays, and the file to which it leads is written. A file that
// did not exist when the object was made is not replaced; one that did must be empty or of the command's
// kind, then and at the commit. All functions throw std::runtime_error with the path and the cause.
class OutputFile {
 public:
  // Throws also if a file must not be replaced, is one of `others` (those that the command reads or writes
  // too), or would lie in a result folder of `run`, or if the folder is not writable. Changes nothing.
  OutputFile(const std::filesystem::path& path, FileKind kind, const std::vector<NamedFile>& others = {});

  void write(std::string_view bytes) { aside().write(bytes); }
  // The new content. The first call makes its file.
  AsideFile& aside();
  // Makes the new content durable. Several files that belong together are all completed before the first of
  // them is committed.
  void complete() { aside().complete(); }
  void commit();

 private:
  // Whether there is a file.
  bool check() const;
  [[noreturn]] void refuse(const std::string& cause) const;

  std::string name_;
  std::filesystem::path path_;
  FileKind kind_;
  bool was_there_ = false;
  std::optional<AsideFile> aside_;
};

// Renames a file or a folder. Throws std::filesystem::filesystem_error if `to` exists.
void rename_to_new(const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace stereotlm::files
