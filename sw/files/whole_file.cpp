#include "sw/files/whole_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <system_error>

#include "sw/files/new_file.h"

namespace stereotlm::files {

void write_whole_file(const std::filesystem::path& path, std::string_view bytes) {
  NewFile file(path);
  file.write(bytes);
  file.close();
}

std::string read_whole_file(const std::filesystem::path& path, std::uintmax_t most_bytes) {
  namespace fs = std::filesystem;
  const auto refuse = [&path](const std::string& cause) {
    throw std::runtime_error("'" + path.string() + "': " + cause);
  };
  std::error_code error;
  const auto status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) refuse("no such file");
  if (error) refuse(error.message());
  if (!fs::is_regular_file(status)) refuse("must be a regular file");
  const std::uintmax_t bytes = fs::file_size(path, error);
  if (error) refuse(error.message());
  if (bytes > most_bytes) refuse(fmt::format("{} bytes: must be {} at most", bytes, most_bytes));
  std::ifstream file(path, std::ios::binary);
  std::string content((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  if (!file.is_open() || file.bad()) refuse(std::strerror(errno));
  return content;
}

void sync_folder(const std::filesystem::path& folder) {
  const auto fail = [&folder](int error) {
    throw std::system_error(error, std::generic_category(), folder.string());
  };
  const int descriptor = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) fail(errno);
  const int error = fsync(descriptor) == 0 ? 0 : errno;
  close(descriptor);
  // File systems without sync return EINVAL or ENOTSUP.
  if (error != 0 && error != EINVAL && error != ENOTSUP) fail(error);
}

}  // namespace stereotlm::files
