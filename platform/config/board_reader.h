#pragma once

#include <vector>

#include "platform/config/board_config.h"
#include "platform/config/value_reader.h"
#include "platform/config/yaml_tree.h"

namespace stereotlm::platform {

// Reads the whole tree of a board, presets and `--set` already put in. Appends everything that is wrong to
// `findings`; the result is only a board if nothing was appended. With `report_missing` false a key that is
// not there is no finding (because the preset that should supply it could not be found).
BoardConfig read_board(const YamlNode& tree, bool report_missing, std::vector<Finding>& findings);

}  // namespace stereotlm::platform
