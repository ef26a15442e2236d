#include "sw/paper/area_fit.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

#include "models/area/area.h"

namespace stereotlm::paper {
namespace {

const area::Device& kXc2v6000 = *area::find_device("xc2v6000");

double modelled_percent(const PrintedArea& row) {
  return area::total(area::items(row.core), kXc2v6000).slices_percent;
}

TEST(AreaFit, IsTheConstantOfTheModel) {
  // Both as printed, with four decimals.
  EXPECT_NEAR(fit_area(table_2(), kXc2v6000).slices_per_lut_equivalent, area::kSlicesPerLutEquivalent,
              0.00005);
}

TEST(AreaFit, HasTheDocumentedErrorsBelowAPercentagePoint) {
  struct Row {
    int disparities;
    double printed_percent;
    double error_points;
  };
  const std::vector<Row> documented = {{80, 21, 0.96}, {160, 43, 0.02}, {200, 54, -0.41}};
  const std::vector<PrintedArea> rows = table_2();
  const AreaFit fit = fit_area(rows, kXc2v6000);
  ASSERT_EQ(rows.size(), documented.size());
  ASSERT_EQ(fit.slices_percent.size(), rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    SCOPED_TRACE(documented[i].disparities);
    EXPECT_EQ(rows[i].core.disparities, documented[i].disparities);
    EXPECT_EQ(rows[i].slices_percent, documented[i].printed_percent);
    const double modelled = modelled_percent(rows[i]);
    EXPECT_NEAR(modelled - documented[i].printed_percent, documented[i].error_points, 0.005);
    EXPECT_NEAR(modelled, fit.slices_percent[i], 0.01);
  }
}

TEST(AreaFit, FindsTheConstantOfRowsThatFollowTheModel) {
  std::vector<PrintedArea> rows = table_2();
  for (PrintedArea& row : rows) {
    const auto places = static_cast<double>(area::total(area::items(row.core), kXc2v6000).lut_equivalents);
    row.slices_percent = 100 * 0.75 * places / 33'792;
  }
  const AreaFit fit = fit_area(rows, kXc2v6000);
  EXPECT_NEAR(fit.slices_per_lut_equivalent, 0.75, 1e-12);
  for (std::size_t i = 0; i < rows.size(); ++i)
    EXPECT_NEAR(fit.slices_percent[i], rows[i].slices_percent, 1e-9);
}

TEST(AreaFit, RefusesNoRowsAndACoreWithProblems) {
  EXPECT_THROW(fit_area({}, kXc2v6000), std::invalid_argument);
  std::vector<PrintedArea> rows = table_2();
  rows[1].core.disparities = 0;
  EXPECT_THROW(fit_area(rows, kXc2v6000), std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::paper
