#include "platform/config/text_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "platform/config/board_yaml.h"

namespace stereotlm::platform {
namespace {

[[noreturn]] void refuse(const std::string& path, const std::string& text) {
  throw BoardError({{path, text}});
}

}  // namespace

std::string read_text_file(const std::string& path, const std::string& kind) {
  constexpr std::size_t kLargestBytes = std::size_t{1} << 20;
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) refuse(path, "a folder, not a " + kind);
  std::ifstream file(path, std::ios::binary);
  if (!file) refuse(path, fmt::format("cannot be read: {}", std::strerror(errno)));
  std::string text(kLargestBytes + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (file.bad()) refuse(path, "cannot be read: input error");
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() > kLargestBytes)
    refuse(path, fmt::format("larger than {} bytes: not a {}", kLargestBytes, kind));
  return text;
}

}  // namespace stereotlm::platform
