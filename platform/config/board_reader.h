#pragma once

#include <vector>

#include "platform/config/board_config.h"
#include "platform/config/value_reader.h"
#include "platform/config/yaml_tree.h"

namespace stereotlm::platform {

// Reads the tree of a board into which presets and `--set` values are merged. Appends each problem to
// `findings`; the result is valid only if nothing was appended. With `report_missing` false a missing key is
// no problem: the preset that should supply it does not exist.
BoardConfig read_board(const YamlNode& tree, bool report_missing, std::vector<Finding>& findings);

}  // namespace stereotlm::platform
