#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "models/kernels/gray_image.h"
#include "platform/config/tables.h"
#include "sw/report/page_data/recording_data.h"
#include "sw/runs/explanation.h"
#include "sw/runs/recorded_run.h"

namespace stereotlm::report {

// Parts of a page's data (sw/report/page/README.md).

// The URL of a picture.
std::string picture_url(const kernels::GrayImage& picture);

// A recorded run: what its folder holds, and what follows from its board without a simulation.
nlohmann::ordered_json run_data(const runs::RecordedRun& run, const platform::Tables& tables);

// Repeats the run and adds what only a repetition shows: `recording`, and `pictures.left`, the left picture
// of the last frame as the matcher sees it. Returns false if interrupted. Throws what Rerun::next() throws.
bool add_repetition(const runs::RecordedRun& run, runs::RunInput& input, nlohmann::ordered_json& data);

// Adds `recording` from the files of the run's folder, if it was run with --record. Throws std::runtime_error
// if they are not as `run --record` writes them.
void add_recorded_files(const runs::RecordedRun& run, nlohmann::ordered_json& data);

// The part `knobs`: what one step of each knob gains, and what it takes of the FPGA.
nlohmann::ordered_json knobs_data(const platform::BoardConfig& board, runs::Explanation& explanation);

// One of two compared runs, and what its repetition has recorded of waits.
struct ComparedRun {
  const runs::RecordedRun& run;
  const platform::Tables& tables;
  RecordingData waits;
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
