#include "sw/media/media_errors.h"

#include <fmt/format.h>

#include <filesystem>
#include <stdexcept>
#include <system_error>

namespace stereotlm::media {

void throw_media_error(const std::string& path, const std::string& found, const std::string& rule) {
  throw std::runtime_error(fmt::format("'{}': {}: {}", path, found, rule));
}

void check_regular_file(const std::string& path, const std::string& rule) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found) throw_media_error(path, "no such file", rule);
  if (error) throw_media_error(path, error.message(), rule);
  if (std::filesystem::is_directory(status)) throw_media_error(path, "a directory", rule);
  if (!std::filesystem::is_regular_file(status)) throw_media_error(path, "not a regular file", rule);
}

}  // namespace stereotlm::media
