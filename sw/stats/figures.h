#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "platform/config/board_config.h"
#include "platform/figures/statistics.h"
#include "sw/stats/accuracy.h"

namespace stereotlm::stats {

// A figure of a point of a sweep: a column of its database that is no key.
struct Figure {
  std::string name;  // its path in point_document(); NAME stands for that of a bank, port, buffer, ..
  std::string unit;  // empty: none
  std::string meaning;
  bool is_text = false;
};

// All figures that a point can have, in the order of point_document(). They follow from the keys of
// stats.json.
const std::vector<Figure>& figures();
// The figure of a column, such as "banks.bank0.reads" or "ports.left_lut.3.grants"; null if there is none.
const Figure* find_figure(const std::string& column);
// "unknown figure NAME; nearest: X", or without the last part if no figure is near.
std::string unknown_figure_text(const std::string& name);
// The figures that a misspelt name may mean, as names for platform::nearest_path(): NAME is that of `name`.
std::vector<std::string> figure_names_like(const std::string& name);

// The column of a figure. A figure with the path of a key of boards ends in ".counted", because both have a
// column: bridge.posted_words is how many words the bridge can hold, bridge.posted_words.counted how many it
// has taken.
std::string figure_column(const std::string& path);

// What a database keeps of a point: stats.json, and the pins of the FPGA, the smallest device that fits, and
// the pixels that the captures of a computer lose.
nlohmann::ordered_json point_document(const platform::Statistics& statistics,
                                      const platform::BoardConfig& board,
                                      const std::optional<Accuracy>& accuracy);

}  // namespace stereotlm::stats
