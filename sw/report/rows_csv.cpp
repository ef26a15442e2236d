#include "sw/report/rows_csv.h"

#include <fmt/format.h>

#include <string>

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

RowsCsv::RowsCsv(const std::filesystem::path& path)
    : file_(path, files::marked_kind("table of stereotlm diff", {{0, head()}})) {
  file_.write(head());
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
  file_.write(lines);
}

}  // namespace stereotlm::report
