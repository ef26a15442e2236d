#include <fmt/format.h>

#include <stdexcept>

#include "models/kernels/limits.h"
#include "platform/bounds.h"
#include "platform/config/board_yaml.h"
#include "sw/cli/command.h"
#include "sw/cli/run_options.h"
#include "sw/files/output_folder.h"
#include "sw/media/load.h"
#include "sw/paper/document.h"
#include "sw/paper/study.h"
#include "sw/runs/progress.h"
#include "sw/runs/simulation/simulate_point.h"
#include "sw/runs/sources/calibration_input.h"
#include "sw/runs/sources/open_source.h"
#include "sw/stats/accuracy.h"

namespace stereotlm::cli {
namespace {

constexpr const char* kPaperFooter =
    "Written are paper.md, every claim with paper value, model value, bound, rule, verdict and the commands\n"
    "that give the numbers again; claims.csv with a row for each case; table1.csv, table2.csv, banks.csv\n"
    "and costs.csv; figures table1, table2 and banks as .png and .svg. Other files in DIR stay; files of\n"
    "these names are replaced if paper.md is there. \"At least eight banks\" is settled with every "
    "allocation\n"
    "of the core alone; of the whole computer some allocations are run, see stereotlm allocate for all of\n"
    "them. \"Almost the same results\" of other costs is judged on synthetic scenes, and on the pair of\n"
    "--left, --right and --truth too, with as many disparities as its truth needs.";

struct PaperOptions : Options {
  using Options::Options;

  void check_together(process::Problems& problems) override {
    for (const auto& [name, is_given] : {std::pair("--left", left.is_given()),
                                         {"--right", right.is_given()},
                                         {"--truth", truth.file.is_given()}}) {
      if (has_pair() && !is_given)
        problems.add(fmt::format("{}: missing: a pair has --left F, --right F and --truth F", name));
    }
  }
  bool has_pair() const { return left.is_given() || right.is_given() || truth.file.is_given(); }

  Option out = Option(this, "--out", "DIR", "The folder to write, created if missing",
                      {required("the folder to write")});
  Option left = Option(
      this, "--left", "F",
      fmt::format(
          "The left picture of a rectified pair with ground truth, 8-bit, as large as the images of {}",
          paper::kBoard));
  Option right = Option(this, "--right", "F", "The right picture");
  TruthOptions truth{this, "the left picture"};
};

struct Pictures {
  std::unique_ptr<runs::PairSource> pairs;
  media::Truth truth;
};

struct LoadedPair {
  paper::GivenPair files;
  Pictures pictures;
  std::vector<std::string> notes;  // for standard error
};

// Returns nullopt, without a problem, if no pair is given. Reports problems.
std::optional<LoadedPair> load_pair(const PaperOptions& options, process::Problems& problems) {
  if (!options.has_pair()) return std::nullopt;
  const platform::BoardConfig board = platform::load_board(paper::kBoard);
  runs::InputPictures source;
  source.left = {options.left.text(), ""};
  source.right = {options.right.text(), ""};
  runs::OpenedSource opened = runs::open_source(source, &board, problems);
  const runs::NamedFile file = {"--truth", options.truth.file.text()};
  auto truth = runs::open_truth(file, options.truth.scale(), &board, problems);
  if (!opened.pairs || !truth) return std::nullopt;
  const kernels::GrayImage blank(board.image.width, board.image.height);
  if (!stats::accuracy(blank, *truth).answered_percent)
    problems.add(file.text() + ": no pixel that both cameras see has a known disparity");
  const double disparities = media::disparities_needed(*truth);
  const kernels::IntegerRule& rule = kernels::kDisparitiesRule;
  if (disparities > static_cast<double>(rule.max)) {
    problems.add(fmt::format("{}, --truth-scale {}: needs {:.0f} disparities: must be {}", file.text(),
                             options.truth.scale(), disparities, rule.text()));
    return std::nullopt;
  }
  return LoadedPair{{options.left.text(), options.right.text(), options.truth.file.text(),
                     options.truth.scale(), static_cast<int>(disparities)},
                    {std::move(opened.pairs), std::move(*truth)},
                    opened.notes};
}

Pictures synthetic_pictures(const platform::BoardConfig& board, std::uint64_t seed) {
  process::Problems none;
  runs::InputPictures source;
  source.synthetic = seed;
  auto pairs = runs::open_source(source, &board, none).pairs;
  media::Truth truth = pairs->truth(0).value();
  return {std::move(pairs), std::move(truth)};
}

// The accuracy of a board's disparities for the first pair of the pictures. Zero after an interrupt.
paper::Quality quality(const platform::BoardConfig& board, const Pictures& pictures) {
  const auto run = runs::simulate_pixels(board, runs::tables_of(board, std::nullopt), *pictures.pairs, 1);
  if (process::interrupted()) return {};
  const stats::Accuracy found = stats::accuracy(run.last, pictures.truth);
  if (!found.bad_1_percent) throw std::runtime_error("the board answers no pixel whose disparity is known");
  return {*found.bad_1_percent, found.answered_percent.value()};
}

// Simulates everything that the claims of the paper need. Returns nullopt if interrupted.
std::optional<paper::Findings> study(const std::optional<LoadedPair>& given) {
  runs::PointSimulator simulator;
  runs::ProgressLine progress("the boards of the paper's tables and claims are simulated");
  paper::Means means;
  means.evaluate = [&simulator](const explore::Point& point) { return simulator(point); };
  means.bound = [](const platform::BoardConfig& board) {
    return platform::core_bound(board, runs::tables_of(board, std::nullopt));
  };
  means.quality = [&given](const platform::BoardConfig& board, const paper::Scene& scene) {
    return scene.synthetic ? quality(board, synthetic_pictures(board, *scene.synthetic))
                           : quality(board, given.value().pictures);
  };
  means.keep_going = [&progress](std::uint64_t done, std::uint64_t most_left) {
    progress.show(done, done + most_left, [&](double) {
      return fmt::format("{} boards simulated, {} left at most", done, most_left);
    });
    return !process::interrupted();
  };
  const auto claims = paper::claims(given ? std::optional(given->files) : std::nullopt);
  return paper::study(claims, means);
}

files::OutputContent content_of(const PaperOptions& options) {
  files::OutputContent content;
  content.called = "folder";
  content.mark = paper::kDocument;
  content.kind = files::marked_kind("document of stereotlm paper", {{0, paper::kDocumentMark}});
  content.rule = "only files of an earlier result are replaced";
  content.names = {paper::kDocument, "@(table1|table2|banks).@(csv|png|svg)", "@(costs|claims).csv"};
  content.others_stay = true;
  content.inputs = {{"--left", options.left.text()},
                    {"--right", options.right.text()},
                    {"--truth", options.truth.file.text()}};
  return content;
}

int compare_with_paper(const PaperOptions& options) {
  process::catch_interrupts();
  process::Problems problems;
  check_temporary_folder(problems);
  const auto given = load_pair(options, problems);
  std::unique_ptr<files::OutputFolder> folder;
  problems.attempt(fmt::format("--out {}: ", options.out.text()), [&] {
    folder = std::make_unique<files::OutputFolder>(options.out.text(), content_of(options));
  });
  problems.check();
  if (given) {
    for (const std::string& note : given->notes) process::say("note", note);
  }
  const auto findings = study(given);
  NamedBytes files = findings ? paper::tables(*findings) : NamedBytes();
  auto figures = findings ? drawn("plot_paper.py", files) : std::nullopt;
  if (!figures) return interrupted("nothing was written");
  files.merge(*figures);
  files[paper::kDocument] = paper::document(*findings);
  for (const auto& [name, bytes] : files) folder->add(name, bytes);
  folder->commit();
  process::print(with_coloured_words(paper::summary(*findings), 0,
                                     {{"  not confirmed\n", process::Colour::kRed},
                                      {"  in part\n", process::Colour::kYellow},
                                      {"  open\n", process::Colour::kYellow},
                                      {"  confirmed\n", process::Colour::kGreen}}) +
                 fmt::format("{}: {} files\n", options.out.text(), files.size()));
  return kDone;
}

}  // namespace

void add_paper(Commands& commands) {
  add_command(commands, "paper", "Compare the paper's figures with the model's", compare_with_paper,
              kPaperFooter);
}

}  // namespace stereotlm::cli
