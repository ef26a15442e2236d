#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "platform/figures/statistics.h"
#include "sw/files/output_folder.h"
#include "sw/runs/run_input.h"
#include "sw/runs/simulation/simulation.h"
#include "sw/stats/console_table.h"

namespace stereotlm::runs {

// The file name of a frame's disparities in a result folder: "frames/000000.png".
std::string frame_file_name(std::uint64_t frame);

// The folder of `run --out`: one result and nothing else. Its mark is run.json. `inputs`: see OutputContent.
files::OutputContent result_content(std::vector<files::NamedFile> inputs = {});

// The truth that a client has sent: the name of its array, and of its file in the result folder.
inline constexpr const char* kKeptTruth = "truth.pfm";

// Adds a file that a client has sent to the result folder.
InputFile keep_file(const std::string& name, const std::string& content, files::OutputFolder& folder);

// Adds pictures that are in no files to the result folder, and returns them as a sequence there.
InputFolder keep_pictures(PairSource& pairs, files::OutputFolder& folder);

// With --save-frames: adds the disparities of this frame to the result folder, which deliver() commits, and
// sends them to the client.
// Throws std::runtime_error if they cannot be written.
void save_frame(const RunInput& input, const Result& result);

// The frames that a run records without --record.
inline constexpr std::uint64_t kRecordedFrames = 60;

// Takes what the simulation has recorded since the last add(). With RunInput::recorded_frames it appends this
// to the files of the result folder, which the constructor begins: the rows of these frames, the time line
// until the last of them is delivered, and all latencies. With --trace it hands all records to the traces;
// the caller commits them. finish() adds what is complete only at the end of the run.
class Records {
 public:
  explicit Records(const RunInput& input);
  void add(Simulation& simulation);
  void finish(Simulation& simulation);

 private:
  const RunInput& input_;
  std::uint64_t end_ps_ = UINT64_MAX;  // of the time line in the folder
};

// For a run that ended after `frames_done` frames: drops --truth, and prints a note, if the last frame does
// not show the pair that the truth belongs to.
void leave_out_truth_of_another_pair(RunInput& input, std::uint64_t frames_done);

// For a run whose comparison was interrupted: drops --verify and prints a note. Otherwise the result would
// claim a comparison that did not take place.
void leave_out_verify(RunInput& input);

// Prints a warning if captures have lost pixels. `subject`: what it begins with.
void say_lost_pixels(const platform::Statistics& statistics, const std::string& subject = "");

// Writes the result files, sends the disparities to a client, and prints the table, or with --json the
// document, or what `text_of` returns. `last`: the result of the last frame. `differences`: found by
// --verify. Prints the differences
// and the identities that do not hold, and lists them as `failed` in stats.json. Returns true if there are no
// differences and all identities hold. Throws std::runtime_error if the files cannot be written; an earlier
// result is then unchanged.
bool deliver(RunInput& input, const platform::Statistics& statistics, const Result& last,
             const std::vector<std::string>& differences = {},
             const std::function<std::string(const stats::TableExtras&)>& text_of = nullptr);

}  // namespace stereotlm::runs
