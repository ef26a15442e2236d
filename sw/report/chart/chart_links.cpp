#include "sw/report/chart/chart_links.h"

#include <algorithm>

#include "models/capture/camera_timing.h"
#include "platform/config/buffer_layout.h"

namespace stereotlm::report {
namespace {

using platform::BoardConfig;
using platform::Buffer;

constexpr double kBytesPerWord = 4;

void add_parts_around(const BoardConfig& board, std::vector<ChartLink>& links) {
  const double camera =
      capture::CameraTiming::peak_pixels_per_second(
          {board.image.width, board.image.height, board.cameras.frame_rate_hz, board.cameras.trigger}) /
      1e6;
  const double pci = kBytesPerWord * board.pci.clock_mhz * board.pci.width_bits / 32;
  const double local = kBytesPerWord * board.bridge.local_clock_mhz;
  links.push_back({"part-left_camera", "part-left_capture", true, false, camera});
  links.push_back({"part-right_camera", "part-right_capture", true, false, camera});
  links.push_back({"part-left_capture", "part-pci", true, false, pci});
  links.push_back({"part-right_capture", "part-pci", true, false, pci});
  links.push_back({"part-cpu", "part-pci", true, true, pci});
  links.push_back({"part-pci", "part-host_memory", true, true, pci});
  if (board.pci.load) links.push_back({"part-load", "part-pci", true, true, pci});
  links.push_back({"part-pci", "part-bridge", true, false, pci});
  links.push_back({"part-bridge", "part-pci", true, true, pci});
  links.push_back({"part-bridge", "part-local_bus", true, true, local});
  links.push_back({"part-local_bus", "port-host", true, true, local});
}

// The host writes pictures and tables, and reads results.
void add_host_port(const BoardConfig& board, std::vector<ChartLink>& links) {
  for (const platform::BankConfig& bank : board.banks) {
    ChartLink link{"port-host", "bank-" + bank.name, false, false, kBytesPerWord * board.fpga.clock_mhz};
    for (const platform::PlacedBuffer& buffer : platform::buffers(board)) {
      if (buffer.bank == bank.name) (buffer.buffer == Buffer::kDisparity ? link.back : link.there) = true;
    }
    if (link.there || link.back) links.push_back(link);
  }
}

}  // namespace

std::string ChartLink::id() const { return "edge-" + name_of_block(from) + "-" + name_of_block(to); }

std::string name_of_block(const std::string& id) { return id.substr(id.find('-') + 1); }

std::vector<std::string> banks_of(const BoardConfig& board, const fpga::CorePort& port) {
  std::vector<std::string> banks;
  for (const platform::PlacedBuffer& buffer : platform::buffers(board)) {
    if (std::string(platform::name_of(buffer.buffer)) == port.buffer) banks.push_back(buffer.bank);
  }
  return banks;
}

std::vector<ChartLink> chart_links(const BoardConfig& board, ChartExtent extent) {
  std::vector<ChartLink> links;
  if (extent == ChartExtent::kComputer) add_parts_around(board, links);
  for (const fpga::CorePort& port : fpga::kPorts) {
    const std::vector<std::string> used = banks_of(board, port);
    for (const platform::BankConfig& bank : board.banks) {
      if (std::find(used.begin(), used.end(), bank.name) == used.end()) continue;
      links.push_back({std::string("port-") + port.name, "bank-" + bank.name, port.write, !port.write,
                       kBytesPerWord * board.fpga.clock_mhz});
    }
  }
  if (extent == ChartExtent::kComputer) add_host_port(board, links);
  return links;
}

}  // namespace stereotlm::report
