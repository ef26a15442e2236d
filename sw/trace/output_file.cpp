#include "sw/trace/output_file.h"

#include <fmt/format.h>

#include <stdexcept>
#include <system_error>

namespace stereotlm::trace {
namespace {

// Calls `action`. Its system errors get the name of the file that the user knows.
template <typename Action>
auto with_name(const std::filesystem::path& path, const Action& action) {
  try {
    return action();
  } catch (const std::system_error& error) {
    throw std::runtime_error(fmt::format("{}: {}", path.string(), error.code().message()));
  }
}

}  // namespace

OutputFile::OutputFile(const std::filesystem::path& path)
    : path_(path), file_(with_name(path, [&path] { return files::ReplacedFile(path); })) {
  files::remove_left_aside(path);
}

void OutputFile::flush() {
  with_name(path_, [this] { file_.write(buffer_); });
  buffer_.clear();
}

void OutputFile::write_through(std::string_view bytes) {
  flush();
  with_name(path_, [this, bytes] { file_.write(bytes); });
}

void OutputFile::complete() {
  flush();
  with_name(path_, [this] { file_.complete(); });
}

void OutputFile::commit() {
  with_name(path_, [this] { file_.commit(); });
}

}  // namespace stereotlm::trace
