#include "sw/cli/rig_files.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <system_error>

namespace stereotlm::cli {

namespace fs = std::filesystem;

RigFiles rig_files(const std::string& calibration) {
  const fs::path path = calibration;
  if (path.extension() != ".yaml") {
    throw std::runtime_error(fmt::format("'{}': the file of a calibration must end in .yaml", calibration));
  }
  const auto beside = [&path](const char* ending) {
    return path.parent_path() / (path.stem().string() + ending);
  };
  return {path, beside("_left.lut"), beside("_right.lut"), beside("_drawings"), beside("_pictures")};
}

std::string read_file(const fs::path& path) {
  std::error_code error;
  const auto status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) {
    throw std::runtime_error(fmt::format("'{}': no such file", path.string()));
  }
  if (error) throw std::runtime_error(fmt::format("'{}': {}", path.string(), error.message()));
  if (!fs::is_regular_file(status)) {
    throw std::runtime_error(fmt::format("'{}': must be a regular file", path.string()));
  }
  std::ifstream file(path, std::ios::binary);
  std::string content((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  if (!file.is_open() || file.bad()) {
    throw std::runtime_error(fmt::format("'{}': {}", path.string(), std::strerror(errno)));
  }
  return content;
}

}  // namespace stereotlm::cli
