#include "models/fpga/core_config.h"

namespace stereotlm::fpga {
namespace {

class Rules {
 public:
  void range(const char* field, int value, int low, int high) {
    if (value < low || value > high) fail(field, value, std::to_string(low) + ".." + std::to_string(high));
  }
  void fail(const char* field, int value, const std::string& rule) {
    found_.push_back(std::string(field) + " = " + std::to_string(value) + ": must be " + rule);
  }
  std::vector<std::string>& found() { return found_; }

 private:
  std::vector<std::string> found_;
};

}  // namespace

std::vector<std::string> problems(const CoreConfig& config) {
  Rules rules;
  if (config.width < 4 || config.width > 2048 || config.width % 4 != 0) {
    rules.fail("width", config.width, "a multiple of 4, 4..2048");
  }
  rules.range("height", config.height, 1, 2048);
  if (config.window < 3 || config.window > 31 || config.window % 2 == 0) {
    rules.fail("window", config.window, "odd, 3..31");
  }
  rules.range("disparities", config.disparities, 1, 254);
  if (config.lr_tolerance) rules.range("lr_tolerance", *config.lr_tolerance, 0, 253);
  rules.range("lane_fifo_slots", config.lane_fifo_slots, 1, 64);
  rules.range("result_fifo_words", config.result_fifo_words, 1, 64);
  rules.range("pipeline_latency_cycles", config.pipeline_latency_cycles, 0, 1024);
  if (!(config.clock_mhz >= 1 && config.clock_mhz <= 1000)) {
    rules.found().push_back("clock_mhz = " + std::to_string(config.clock_mhz) + ": must be 1..1000");
  }
  if (config.filter) {
    for (const std::string& problem : kernels::problems(*config.filter))
      rules.found().push_back("filter: " + problem);
  }
  return rules.found();
}

}  // namespace stereotlm::fpga
