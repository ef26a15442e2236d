#include "sw/cli/run_results.h"

#include "sw/cli/media_library.h"
#include "sw/cli/streams.h"
#include "sw/report/accuracy.h"
#include "sw/report/console_table.h"
#include "sw/report/stats_json.h"

namespace stereotlm::cli {
namespace {

void write_files(RunInput& input, const platform::Statistics& statistics, const kernels::GrayImage& disparity,
                 const std::optional<report::Accuracy>& accuracy) {
  const MediaFunctions& media = media_functions();
  report::ResultFolder& folder = *input.folder;
  folder.add("disparity.png", media.encode_png_gray(disparity));
  folder.add("disparity.pfm", media.encode_pfm(disparity));
  folder.add("disparity_color.png",
             media.encode_disparity_color_png(disparity, input.board.matcher.disparities));
  folder.add("stats.json", report::stats_json(statistics, accuracy));
  folder.add("config.yaml", input.config_yaml);
  // An interrupted run is the same as a whole one of the frames that it finished.
  input.described.frames = statistics.frames;
  folder.add("run.json", report::run_json(input.described));
  folder.commit();
}

}  // namespace

bool deliver(RunInput& input, const platform::Statistics& statistics, const kernels::GrayImage& disparity) {
  std::optional<report::Accuracy> accuracy;
  if (input.truth) accuracy = report::accuracy(disparity, *input.truth);
  if (input.folder) write_files(input, statistics, disparity, accuracy);
  for (const std::string& identity : statistics.failed) say("error", "identity does not hold: " + identity);
  print(report::console_table(statistics, input.board.fpga.clock_mhz, accuracy));
  return statistics.failed.empty();
}

}  // namespace stereotlm::cli
