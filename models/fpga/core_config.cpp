#include "models/fpga/core_config.h"

namespace stereotlm::fpga {

std::vector<std::string> problems(const CoreConfig& config) {
  std::vector<std::string> found;
  kWidthRule.check("width", config.width, found);
  kHeightRule.check("height", config.height, found);
  kernels::kWindowRule.check("window", config.window, found);
  kernels::kDisparitiesRule.check("disparities", config.disparities, found);
  if (config.lr_tolerance) kernels::kLrToleranceRule.check("lr_tolerance", *config.lr_tolerance, found);
  kLaneFifoRule.check("lane_fifo_slots", config.lane_fifo_slots, found);
  kResultFifoRule.check("result_fifo_words", config.result_fifo_words, found);
  kPipelineLatencyRule.check("pipeline_latency_cycles", config.pipeline_latency_cycles, found);
  if (!(config.clock_mhz >= 1 && config.clock_mhz <= 1000)) {
    found.push_back("clock_mhz = " + std::to_string(config.clock_mhz) + ": must be 1..1000");
  }
  if (config.filter) {
    for (const std::string& problem : kernels::problems(*config.filter))
      found.push_back("filter: " + problem);
  }
  return found;
}

}  // namespace stereotlm::fpga
