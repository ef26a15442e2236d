#include "models/fpga/core_config.h"

#include <set>

#include "models/fpga/register_map.h"

namespace stereotlm::fpga {

std::vector<std::string> problems(const CoreConfig& config) {
  std::vector<std::string> found;
  const bool has_table = config.left_table || config.right_table;
  const auto check_size = [&](const char* field, int value, const kernels::IntegerRule& rule,
                              const kernels::IntegerRule& with_table) {
    if (!has_table) return rule.check(field, value, found);
    if (!with_table.allows(value))
      found.push_back(with_table.problem(field, value) + "; a side has a look-up table");
  };
  check_size("width", config.width, kWidthRule, kWidthWithTableRule);
  check_size("height", config.height, kHeightRule, kHeightWithTableRule);
  kernels::kWindowRule.check("window", config.window, found);
  kernels::kDisparitiesRule.check("disparities", config.disparities, found);
  if (config.units) {
    kUnitsRule.check("units", *config.units, found);
    if (!has_units_for(config.units, config.disparities))
      found.push_back("units = " + std::to_string(*config.units) +
                      ": must be at most disparities, which is " + std::to_string(config.disparities));
  }
  kRowsRule.check("rows", config.rows, found);
  if (!can_fetch_rows(config.fetch, config.rows))
    found.push_back("rows = " + std::to_string(config.rows) + ": must be 1 with the line buffer");
  for (const std::string& problem : kernels::problems(config.cost)) found.push_back("cost: " + problem);
  if (config.joint_tables && !(config.left_table && config.right_table))
    found.emplace_back("joint_tables = true: both sides must have a table");
  if (config.lr_tolerance) kernels::kLrToleranceRule.check("lr_tolerance", *config.lr_tolerance, found);
  kLaneFifoRule.check("lane_fifo_slots", config.lane_fifo_slots, found);
  kResultFifoRule.check("result_fifo_words", config.result_fifo_words, found);
  if (kResultFifoRule.allows(config.result_fifo_words) && kRowsRule.allows(config.rows) &&
      !can_queue_rows(config.result_fifo_words, config.rows))
    found.push_back("result_fifo_words = " + std::to_string(config.result_fifo_words) +
                    ": must be at least rows, which is " + std::to_string(config.rows));
  kLanesRule.check("lanes", config.lanes, found);
  const int column = config.window + config.rows - 1;
  if (!can_divide_columns(config.fetch, config.lanes)) {
    found.push_back("lanes = " + std::to_string(config.lanes) + ": must be 1 with the line buffer");
  } else if (kLanesRule.allows(config.lanes) && config.lanes > column) {
    found.push_back("lanes = " + std::to_string(config.lanes) +
                    ": must be at most the slots of a column, window + rows - 1, which is " +
                    std::to_string(column));
  }
  for (const std::vector<std::uint32_t>& parts : config.stripes) {
    kStripeRule.check("stripes", static_cast<std::int64_t>(parts.size()), found);
    std::set<std::uint32_t> banks;
    for (const std::uint32_t part : parts) banks.insert(registers::bank_of(part));
    if (banks.size() != parts.size()) found.emplace_back("stripes: the parts must lie in different banks");
  }
  kResultDelayRule.check("result_delay_cycles", config.result_delay_cycles, found);
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
