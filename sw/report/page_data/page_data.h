#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "models/kernels/gray_image.h"
#include "platform/config/tables.h"
#include "sw/runs/explanation.h"
#include "sw/runs/recorded_run.h"
#include "sw/runs/run_input.h"
#include "sw/stats/console_table.h"

namespace stereotlm::report {

class RecordingData;

// Parts of a page's data (sw/report/page/README.md).

// The URL of a picture.
std::string picture_url(const kernels::GrayImage& picture);

// A recorded run: what its folder holds, and what follows from its board without a simulation.
nlohmann::ordered_json run_data(const runs::RecordedRun& run, const platform::Tables& tables);

// A run that has just ended, without `folder` and `command`. `recording`: what it has recorded, or null.
nlohmann::ordered_json run_data(const runs::RunInput& input, const platform::Statistics& statistics,
                                const stats::TableExtras& extras, const runs::Result& last,
                                const RecordingData* recording);

// Adds what the run has recorded: `recording`, and `pictures.left`, the left picture of the last frame as the
// matcher sees it. Returns false, and adds nothing, if its folder has no such files. Throws
// std::runtime_error if they are not as `run` writes them.
bool add_recording(const runs::RecordedRun& run, runs::RunInput& input, nlohmann::ordered_json& data);

// The part `knobs`: what one step of each knob gains, and what it takes of the FPGA.
nlohmann::ordered_json knobs_data(const platform::BoardConfig& board, runs::Explanation& explanation);

// One of two compared runs.
struct ComparedRun {
  const runs::RecordedRun& run;
  const platform::Tables& tables;
};

// What `diff --json` prints of two runs (stats/document_schemas.cpp).
nlohmann::ordered_json diff_document(const runs::RecordedRun& a, const runs::RecordedRun& b,
                                     const runs::FrameAlignment& aligned, const runs::DiffLimits& limits);

// The parts `runs` and `difference`: diff_document() with all rows, its settings as shown_values().
nlohmann::ordered_json two_runs_data(const ComparedRun& a, const ComparedRun& b,
                                     const runs::FrameAlignment& aligned, const runs::DiffLimits& limits);

// The part `database`: the points of a database of `sweep`. Throws sqlite::DatabaseError if the file cannot
// be read or is no such database, and std::runtime_error if it has no points.
nlohmann::ordered_json database_data(const std::string& path);

}  // namespace stereotlm::report
