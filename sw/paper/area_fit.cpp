#include "sw/paper/area_fit.h"

#include <Eigen/Dense>
#include <stdexcept>

#include "models/area/area.h"

namespace stereotlm::paper {

std::vector<PrintedArea> table_2() {
  std::vector<PrintedArea> rows = {{{}, 21}, {{}, 43}, {{}, 54}};
  rows[0].core.disparities = 80;
  rows[1].core.disparities = 160;
  rows[2].core.disparities = 200;
  return rows;
}

AreaFit fit_area(const std::vector<PrintedArea>& rows, const area::Device& device) {
  if (rows.empty()) throw std::invalid_argument("rows = 0: a fit to nothing");
  const auto count = static_cast<Eigen::Index>(rows.size());
  Eigen::VectorXd lut_equivalents(count);
  Eigen::VectorXd percent(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const PrintedArea& row = rows[static_cast<std::size_t>(i)];
    const area::Area area = area::total(area::items(row.core), device);
    lut_equivalents[i] = static_cast<double>(area.lut_equivalents);
    percent[i] = row.slices_percent;
  }
  const double slices_a_percent = static_cast<double>(device.slices) / 100;
  const Eigen::VectorXd constant = lut_equivalents.colPivHouseholderQr().solve(slices_a_percent * percent);
  const Eigen::VectorXd modelled = constant[0] / slices_a_percent * lut_equivalents;
  return {constant[0], {modelled.begin(), modelled.end()}};
}

}  // namespace stereotlm::paper
