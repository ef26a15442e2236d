#include "sw/report/rows_csv.h"

#include <fmt/format.h>

#include <stdexcept>
#include <system_error>

#include "models/fpga/core_ports.h"
#include "sw/report/row_comparison.h"

namespace stereotlm::report {
namespace {

std::string head() {
  std::string text = "frame,row,a_cycles,b_cycles";
  for (const char* run : {"a", "b"}) {
    for (std::size_t port = 0; port < fpga::kCorePortCount; ++port)
      text += fmt::format(",{}_{}_stall_cycles", run, fpga::kPorts[port].name);
  }
  return text + '\n';
}

}  // namespace

RowsCsv::RowsCsv(const std::filesystem::path& path) : path_(path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (std::filesystem::is_directory(status)) refuse("is a folder");
  if (!std::filesystem::status_known(status)) refuse("cannot be written: " + error.message());
  files::remove_left_aside(path);
  try {
    file_ = std::make_unique<files::ReplacedFile>(path);
    file_->write(head());
  } catch (const std::system_error& failure) {
    refuse("cannot be written: " + failure.code().message());
  }
}

void RowsCsv::add(const fpga::RowProfile& a, const fpga::RowProfile& b) {
  const fpga::RowProfile alone_a = rows_alone(a);
  const fpga::RowProfile alone_b = rows_alone(b);
  std::string lines;
  for (std::size_t row = 0; row < a.size(); ++row) {
    lines += fmt::format("{},{},{},{},{},{}\n", frame_, row, alone_a[row].cycles, alone_b[row].cycles,
                         fmt::join(alone_a[row].stalls, ","), fmt::join(alone_b[row].stalls, ","));
  }
  ++frame_;
  try {
    file_->write(lines);
  } catch (const std::system_error& error) {
    refuse("cannot be written: " + error.code().message());
  }
}

void RowsCsv::commit() {
  try {
    file_->commit();
  } catch (const std::system_error& error) {
    refuse("cannot be written: " + error.code().message());
  }
}

void RowsCsv::refuse(const std::string& cause) const {
  throw std::runtime_error(fmt::format("'{}': {}", path_.string(), cause));
}

}  // namespace stereotlm::report
