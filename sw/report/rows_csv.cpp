#include "sw/report/rows_csv.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <system_error>

#include "models/memory/memory_config.h"
#include "sw/report/row_comparison.h"

namespace stereotlm::report {

RowsCsv::RowsCsv(const std::filesystem::path& path) : path_(path), aside_(path.string() + ".part") {
  if (std::filesystem::is_directory(path))
    throw std::runtime_error(fmt::format("'{}': is a folder", path.string()));
  errno = 0;
  file_.open(aside_, std::ios::binary | std::ios::trunc);
  if (!file_) {
    throw std::runtime_error(fmt::format("'{}': cannot be written: {}", path.string(), std::strerror(errno)));
  }
  file_ << "frame,row,a_cycles,b_cycles";
  for (const char* run : {"a", "b"}) {
    for (std::size_t port = 0; port < fpga::kCorePortCount; ++port)
      file_ << fmt::format(",{}_{}_stall_cycles", run, memory::kPortNames[port]);
  }
  file_ << '\n';
}

RowsCsv::~RowsCsv() {
  std::error_code ignored;
  if (file_.is_open()) std::filesystem::remove(aside_, ignored);
}

void RowsCsv::add(const fpga::RowProfile& a, const fpga::RowProfile& b) {
  const fpga::RowProfile alone_a = rows_alone(a);
  const fpga::RowProfile alone_b = rows_alone(b);
  for (std::size_t row = 0; row < a.size(); ++row) {
    file_ << fmt::format("{},{},{},{},{},{}\n", frame_, row, alone_a[row].cycles, alone_b[row].cycles,
                         fmt::join(alone_a[row].stalls, ","), fmt::join(alone_b[row].stalls, ","));
  }
  ++frame_;
}

void RowsCsv::commit() {
  file_.close();
  std::error_code error;
  if (file_) std::filesystem::rename(aside_, path_, error);
  if (!file_ || error) {
    std::error_code ignored;
    std::filesystem::remove(aside_, ignored);
    throw std::runtime_error(fmt::format("'{}': cannot be written", path_.string()));
  }
}

}  // namespace stereotlm::report
