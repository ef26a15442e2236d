#include "sw/paper/document.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <set>

#include "models/area/area.h"
#include "sw/files/text_forms.h"
#include "sw/stats/accuracy.h"

namespace stereotlm::paper {
namespace {

constexpr const char* kHead =
    "The paper: Y. Miyajima and T. Maruyama, \"A Real-Time Stereo Vision\n"
    "System with FPGA\", FPL 2003, LNCS 2778, pp. 448-457. `claims.csv` has every row below, `table1.csv`,\n"
    "`table2.csv` and `banks.csv` what the figures show, `costs.csv` the table of costs, all with every\n"
    "digit.\n\n"
    "- *paper* is the printed value, *model* what the simulation (of the area: the count) gives, *bound*\n"
    "  what the analytic bound allows at most, without a simulation.\n"
    "- A case is confirmed if its rule holds between both values; a claim if all of its cases are, in part\n"
    "  if some are. \"At least the printed value less 0.5\" takes a printed 20 for anything that rounds to "
    "it\n"
    "  or is more.\n"
    "- *The core alone* is fed by an ideal host; *the whole computer* has free-running cameras at 29.97 Hz,\n"
    "  capture boards, PCI bus and driver, and its rate is the steady one, without start-up.\n"
    "- *MHz* is the clock at which the core alone would give what is printed, over the range that is\n"
    "  printed so; the cycles of a frame do not depend on the clock.\n";

std::string three(double value) { return fmt::format("{:.3f}", value); }

// The printed value with as many decimals as in the paper: 10.0 in Table 1, 80 elsewhere.
std::string printed_text(const Claim& claim, double printed) {
  if (claim.quantity == Quantity::kAccuracyChange) return "";  // the paper prints no number
  const bool has_decimals = claim.half_digit > 0 && claim.half_digit < 0.5;
  return fmt::format("{:.{}f}", printed, has_decimals ? 1 : 0);
}

std::string modelled_text(const Claim& claim, double modelled) {
  const bool is_count = claim.quantity == Quantity::kBanksProved || claim.quantity == Quantity::kBanksFound;
  return is_count ? fmt::format("{:.0f}", modelled) : three(modelled);
}

// The deviation, if there is one; in points if the printed value is a percentage.
std::string deviation_text(const Claim& claim, const CaseFinding& finding) {
  if (claim.quantity == Quantity::kSlices)
    return fmt::format("{:+.2f} points", files::without_minus_zero(finding.modelled - finding.of.printed, 2));
  const auto percent = deviation_percent(claim, finding);
  return percent ? fmt::format("{:+.2f} %", files::without_minus_zero(*percent, 2)) : "";
}

std::string confirmed_text(const ClaimFinding& found) {
  const auto confirmed = std::count_if(found.cases.begin(), found.cases.end(), [](const CaseFinding& one) {
    return one.verdict == Verdict::kConfirmed;
  });
  return fmt::format("{} of {}", confirmed, found.cases.size());
}

// For a claim about costs: the scenes on which its verdict rests, in clauses. Empty for other claims.
std::vector<std::string> scene_clauses(const ClaimFinding& found) {
  if (found.claim.quantity != Quantity::kAccuracyChange) return {};
  bool has_pair = false;
  std::vector<std::string> clauses = {"on synthetic scenes only"};
  for (const SceneFinding& scene : scenes_of(found)) {
    const bool is_pair = !scene.scene.synthetic;
    has_pair = has_pair || is_pair;
    if (!scene.judges) {
      clauses.push_back(
          fmt::format("not on {}, whose cases are open: sad itself is wrong in {:.2f} % of its answers",
                      scene.scene.name, scene.wrong_percent));
      clauses.push_back(fmt::format("a pair with more than {:g} % does not judge: check --truth-scale",
                                    stats::kDoubtfulBad1Percent));
    } else if (is_pair) {
      clauses.front() = "on synthetic scenes and " + scene.scene.name;
    }
  }
  if (!has_pair) clauses.emplace_back("give --left, --right and --truth for a real pair");
  return clauses;
}

std::string verdict_text(const ClaimFinding& found) {
  const std::vector<std::string> clauses = scene_clauses(found);
  return text_of(found.verdict) + (clauses.empty() ? "" : ", " + clauses.front());
}

std::string capitalised(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

std::string overview(const Findings& findings) {
  std::string text = "\n| the paper says | where | cases confirmed | verdict |\n|---|---|---|---|\n";
  for (const ClaimFinding& found : findings.claims) {
    text += fmt::format("| {} | {} | {} | **{}** |\n", found.claim.says, found.claim.place,
                        confirmed_text(found), verdict_text(found));
  }
  return text;
}

// The cases of a claim, and the commands that reproduce their numbers.
std::string cases_text(const ClaimFinding& found) {
  const Claim& claim = found.claim;
  const bool has_bound = claim.quantity == Quantity::kRate;
  std::string text = fmt::format(
      "\nRule: {}. In {}.\n\n| case | paper | model |{} deviation |{} verdict |\n|---|---|---|---|---|{}\n",
      text_of(claim.rule), unit_of(claim.quantity), has_bound ? " bound, limited by |" : "",
      has_bound ? " MHz |" : "", has_bound ? "---|---|" : "");
  for (const CaseFinding& finding : found.cases) {
    std::string bound, mhz;
    if (has_bound) {
      const Measured& run = finding.runs.front();
      const auto clock = clock_for(claim, finding);
      bound = fmt::format(" {}, {} |", three(run.bound), run.limited_by);
      mhz = clock ? fmt::format(" {:.2f} .. {:.2f} |", clock->least_mhz, clock->most_mhz) : " |";
    }
    text += fmt::format("| {} | {} | {} |{} {} |{} {} |\n", finding.of.name,
                        printed_text(claim, finding.of.printed), modelled_text(claim, finding.modelled),
                        bound, deviation_text(claim, finding), mhz, text_of(finding.verdict));
  }
  text += "\n```console\n";
  std::set<std::string> said;
  const auto say = [&](const std::string& command) {
    if (said.insert(command).second) text += "$ " + command + '\n';
  };
  for (const Case& one : claim.cases) {
    for (const std::string& command : commands_of(claim, one)) say(command);
    for (const BoardRun& run : one.runs) {
      if (run.scene) say(command_of(run));  // also costs that are not compared
    }
  }
  return text + "```\n";
}

std::string table1_remarks(const ClaimFinding& found) {
  ClockRange others = {0, std::numeric_limits<double>::infinity()};
  for (const CaseFinding& finding : found.cases) {
    if (finding.verdict != Verdict::kConfirmed) continue;
    const ClockRange clock = *clock_for(found.claim, finding);
    others.least_mhz = std::max(others.least_mhz, clock.least_mhz);
    others.most_mhz = std::min(others.most_mhz, clock.most_mhz);
  }
  std::string text =
      "\nMethod: the core alone with its eight banks, 640x480, 80 disparities, no filter, 40 MHz (Table 2\n"
      "prints that clock). `table1.csv` has the rates with the filter `log7` too.\n";
  if (others.least_mhz > others.most_mhz) return text;
  text += fmt::format("The rows that agree are those of one clock, {:.2f} .. {:.2f} MHz.\n", others.least_mhz,
                      others.most_mhz);
  for (const CaseFinding& finding : found.cases) {
    if (finding.verdict == Verdict::kConfirmed) continue;
    const Case& one = finding.of;
    const ClockRange clock = *clock_for(found.claim, finding);
    text += fmt::format("\nThe row of {} deviates by {:.1f} %. Reasons to doubt the printed {:.1f}:\n\n",
                        one.name, std::abs(*deviation_percent(found.claim, finding)), one.printed);
    if (clock.least_mhz > others.most_mhz || clock.most_mhz < others.least_mhz) {
      text += fmt::format(
          "- It needs {:.2f} .. {:.2f} MHz, which the rows that agree exclude. The table is of one circuit, "
          "and\n"
          "  at their clock it would print {:.1f} here.\n",
          clock.least_mhz, clock.most_mhz, finding.modelled);
    }
    const int rows = std::stoi(one.name);  // rows of the window
    if (one.printed - found.claim.half_digit > 40e6 / (640 * 480 * rows)) {
      text += fmt::format(
          "- It is above what the paper's own rule allows at 40 MHz, one pixel a cycle and {0} reads of "
          "each:\n"
          "  40e6 / (640 * 480 * {0}) = {1:.3f}. Table 2 prints the same number beside 40 MHz.\n",
          rows, 40e6 / (640 * 480 * rows));
    }
  }
  return text;
}

std::string table2_remarks(const ClaimFinding& found) {
  double worst = 0;
  for (const CaseFinding& finding : found.cases)
    worst = std::max(worst, std::abs(finding.modelled - finding.of.printed));
  return fmt::format(
      "\nMethod: adders, registers and memories are counted from the structure (`stereotlm bounds\n"
      "--area` lists them); one constant, {:g} slices for each place of a LUT and its flip-flop, is fitted\n"
      "to these rows.\n"
      "What is counted was decided with these rows in view: some 45 more places that do not grow with the\n"
      "disparities, the constant fitted again, take the row of 80 past one point.\n"
      "The largest error is {:.2f} points; a printed whole percentage stands for half a point to each "
      "side.\n\n"
      "That validates that slices grow with the disparities as counted, and no more: three rows, whole\n"
      "percentages, one window, one filter, one fetch. How the area grows with the window, what the filter,\n"
      "the queues or line buffers cost, LUTs, flip-flops, block RAMs and multipliers are counted and "
      "compared\n"
      "with nothing. What all modules have in common goes into the constant. Nothing is placed or routed.\n",
      area::kSlicesPerLutEquivalent, worst);
}

// The camera rate of a claim's boards.
double camera_hz(const Claim& claim) {
  return board_of(claim.cases.back().runs.front()).cameras.frame_rate_hz;
}

std::string practice_remarks(const ClaimFinding& found) {
  std::string text =
      "\nThe paper calls the rates of Table 1 calculated, from the clock that CAD reports, and says this of\n"
      "practice; it gives no other clock. What the core alone would need:\n\n";
  for (const CaseFinding& finding : found.cases) {
    const Case& one = finding.of;
    if (one.runs.front().camera) continue;
    text +=
        fmt::format("- {}: {:.2f} MHz for {:.0f} frames a second\n", one.name,
                    one.printed * board_of(one.runs.front()).fpga.clock_mhz / finding.modelled, one.printed);
  }
  const double hz = camera_hz(found.claim);
  return text + fmt::format(
                    "\nWith cameras that run freely at {:g} Hz and two buffers a side, deliveries lock to a "
                    "fraction of the\n"
                    "camera's rate: 2 in 3 are {:.2f} a second, 3 in 5 {:.2f}. So the \"20\" of a computer "
                    "of this kind\n"
                    "need not be a rate of its circuit.\n",
                    hz, hz * 2 / 3, hz * 3 / 5);
}

std::string any_window_remarks(const ClaimFinding& found) {
  const bool depends = found.verdict == Verdict::kInPart;
  return depends ? "\nIt depends on the window, which the paper does not name here.\n" : "";
}

std::string small_remarks(const ClaimFinding& found) {
  const double hz = camera_hz(found.claim);
  std::string text = any_window_remarks(found);
  if (hz >= found.claim.cases.front().printed) return text;
  return text +
         fmt::format(
             "Of the whole computer the cameras are the limit, whatever the matcher: at {:g} Hz they have no "
             "more\n"
             "pictures to give. The paper names no faster ones; the number can only be the circuit's.\n",
             hz);
}

std::string small_speed_up_remarks(const ClaimFinding& found) {
  std::string text = "\nRates, 320x240 and 640x480:\n\n";
  for (const CaseFinding& finding : found.cases) {
    text += fmt::format("- {}: {} and {} frames/s\n", finding.of.name, three(finding.runs.at(0).rate),
                        three(finding.runs.at(1).rate));
  }
  return text;
}

std::string bank_rows_text(const Findings& findings, const std::string& claim) {
  std::string text =
      "\n| banks | allocations, all simulated | best frames/s | bound | reached by | one of them |\n"
      "|---|---|---|---|---|---|\n";
  for (const BankRow& row : findings.banks) {
    if (row.of != claim) continue;
    text += fmt::format("| {} | {} | {} | {} | {} | {} |\n", row.banks, *row.allocations,
                        three(row.measured.rate), three(row.measured.bound), *row.reached_by, row.allocation);
  }
  return text;
}

std::string banks_remarks(const Findings& findings, const ClaimFinding& found) {
  const auto fewest = static_cast<int>(found.cases.front().modelled);
  const auto printed = static_cast<int>(found.claim.cases.front().printed);
  const BankRow* witness = nullptr;
  const BankRow* fewer = nullptr;
  std::uint64_t below = 0;
  for (const BankRow& row : findings.banks) {
    if (row.of != found.claim.name) continue;
    if (row.banks == fewest) witness = &row;
    if (row.banks >= fewest) continue;
    below += *row.allocations;
    if (fewer == nullptr || row.measured.rate > fewer->measured.rate) fewer = &row;
  }
  std::string text = bank_rows_text(findings, found.claim.name);
  text += fmt::format("\n- Witness: {} banks give the best rate of all, {} frames/s: {}.\n", fewest,
                      three(witness->measured.rate), witness->allocation);
  if (fewer != nullptr) {
    text += fmt::format(
        "- Certificate: none of the {} allocations to fewer banks that fit gives more than {}. Each of them "
        "is\n"
        "  known: a frame leaves nothing behind for the next, every way in which the buffers of one frame "
        "share\n"
        "  banks was simulated, and an allocation is a sum of such frames.\n",
        below, three(fewer->measured.rate));
  }
  const char* const against = fewest < printed ? "fewer than" : fewest == printed ? "just" : "more than";
  text += fmt::format("- So the frame rate of the core needs {} banks, {} the paper's {}.\n", fewest, against,
                      printed);
  if (found.claim.name != "banks") return text;
  return text +
         "\nWhat that leaves out: here pictures appear in their buffers, and results go, in no time; and in "
         "the\n"
         "model host and circuit share a bank cycle by cycle. Where a bank belongs to one of them as a "
         "whole\n"
         "until it is handed over, no buffer that the host fills or empties may lie beside one that the "
         "circuit\n"
         "uses meanwhile. That is a reason for more banks, but not one of the frame rate of the core.\n";
}

std::string banks_of_computer_remarks(const Findings& findings, const ClaimFinding& found) {
  std::string text =
      "\n| banks | frames/s between deliveries | from power-up | bound | allocation "
      "|\n|---|---|---|---|---|\n";
  for (const BankRow& row : findings.banks) {
    if (row.of != found.claim.name) continue;
    text += fmt::format("| {} | {} | {} | {} | {} |\n", row.banks, three(row.measured.rate),
                        three(row.measured.delivered.value_or(0)), three(row.measured.bound), row.allocation);
  }
  const auto found_banks = static_cast<int>(found.cases.front().modelled);
  const auto printed = static_cast<int>(found.claim.cases.front().printed);
  text +=
      found_banks < printed
          ? fmt::format("\n{} banks give what {} give: so {} are not needed; for that a witness is enough.\n",
                        found_banks, printed, printed)
          : fmt::format("\nNone of these gives with fewer banks what {} give: that decides nothing.\n",
                        printed);
  return text +
         "What was run here, one allocation for each number of banks, is no certificate: how few banks would "
         "do,\n"
         "and what the best with 5 or 6 gives, takes all allocations. They are tried by\n"
         "`stereotlm allocate fpl2003 --banks 8 --out banks.db`.\n";
}

std::string costs_remarks(const ClaimFinding& found) {
  std::string text = fmt::format(
      "\nThe paper gives no figures for \"almost same\". So the rule is ours: with the other cost neither\n"
      "the share of wrong answers nor the share of answered pixels changes by more than one point. *Model*\n"
      "is the larger of the two changes. An answer is wrong if it is off by more than 1 disparity. Only\n"
      "pixels count whose truth is known and which both cameras see. A pair on which `sad` itself is wrong\n"
      "in more than {:g} % of its answers does not judge: its cases are open.\n\n"
      "| scene | cost | wrong, % | answered, % | change of wrong | of answered | slices, % | verdict |\n"
      "|---|---|---|---|---|---|---|---|\n",
      stats::kDoubtfulBad1Percent);
  for (const CostRow& row : cost_rows(found)) {
    const bool is_first = row.cost == "sad";
    const auto change = [&](double Quality::*share) {
      return is_first ? std::string()
                      : fmt::format("{:+.3f}", files::without_minus_zero(row.change.*share, 3));
    };
    text +=
        fmt::format("| {} | {} | {:.3f} | {:.3f} | {} | {} | {:.2f} | {} |\n", row.scene, row.cost,
                    row.quality.wrong_percent, row.quality.answered_percent, change(&Quality::wrong_percent),
                    change(&Quality::answered_percent), row.slices_percent,
                    is_first      ? ""
                    : row.verdict ? text_of(*row.verdict)
                                  : "not judged");
  }
  return text +
         "\n- The paper does not name census; it is shown beside.\n"
         "- `zncc` subtracts the mean of each window, as most do; the paper does not say whether it does.\n"
         "- Synthetic scenes have no noise, and both of their cameras see the same grey levels. `zncc` and\n"
         "  census are made for cameras of different gain, which these scenes do not have.\n"
         "- *Slices* are those of the board with that cost. What the area model counts for a cost was\n"
         "  compared with nothing.\n";
}

std::string remarks(const Findings& findings, const ClaimFinding& found) {
  const std::string& name = found.claim.name;
  if (name == "table1") return table1_remarks(found);
  if (name == "table2_size") return table2_remarks(found);
  if (name == "table2_rate") return "\nThe printed value is that of the row 7x7 of Table 1: see there.\n";
  if (name == "practice") return practice_remarks(found);
  if (name == "any_window" || name == "more_any_window") return any_window_remarks(found);
  if (name == "small" || name == "more_small") return small_remarks(found);
  if (name == "small_speed_up") return small_speed_up_remarks(found);
  if (name == "banks_of_computer") return banks_of_computer_remarks(findings, found);
  if (name == "costs") return costs_remarks(found);
  return found.claim.quantity == Quantity::kBanksProved ? banks_remarks(findings, found) : "";
}

// The picture that is shown below a claim, if it has one.
std::string figure_text(const std::string& claim) {
  if (claim == "table1") return "\n![frames per second against the window](table1.png)\n";
  if (claim == "table2_size") return "\n![slices against the disparities](table2.png)\n";
  if (claim == "banks_of_computer") return "\n![best frames per second against the banks](banks.png)\n";
  return "";
}

// The lines of the cases of a claim that are not confirmed, below its name; empty if there are none.
std::string others_text(const ClaimFinding& found) {
  const Claim& claim = found.claim;
  std::string lines;
  if (claim.quantity == Quantity::kAccuracyChange) {
    for (const CostRow& row : cost_rows(found)) {
      if (row.verdict.value_or(Verdict::kConfirmed) == Verdict::kConfirmed) continue;
      lines += fmt::format(
          "  {} on {}: wrong {:+.3f}, answered {:+.3f} percentage points "
          "against sad{}\n",
          row.cost, row.scene, row.change.wrong_percent, row.change.answered_percent,
          row.verdict == Verdict::kOpen ? ", open" : "");
    }
  } else {
    for (const CaseFinding& finding : found.cases) {
      if (finding.verdict == Verdict::kConfirmed) continue;
      const Case& one = finding.of;
      const std::string deviation = deviation_text(claim, finding);
      lines += fmt::format("  {}: {} {} in the paper, {} in the model{}{}\n", one.name,
                           printed_text(claim, one.printed), unit_of(claim.quantity),
                           modelled_text(claim, finding.modelled),
                           deviation.empty() ? "" : fmt::format(" ({})", deviation),
                           finding.verdict == Verdict::kOpen ? ", open" : "");
    }
  }
  return lines.empty() ? "" : fmt::format("{}: {}\n{}", claim.place, claim.says, lines);
}

}  // namespace

std::string document(const Findings& findings) {
  std::string text = std::string(kDocumentMark) + kHead + overview(findings);
  for (const ClaimFinding& found : findings.claims) {
    text += fmt::format("\n## {} ({})\n\n**{}** (cases: {})", capitalised(found.claim.says),
                        found.claim.place, text_of(found.verdict), confirmed_text(found));
    const std::vector<std::string> clauses = scene_clauses(found);
    text += clauses.empty() ? ".\n" : fmt::format(",\n{}.\n", fmt::join(clauses, ";\n"));
    text += cases_text(found) + remarks(findings, found) + figure_text(found.claim.name);
  }
  return text;
}

std::string summary(const Findings& findings) {
  std::vector<const ClaimFinding*> claims;  // those that are doubted first
  std::string verdicts;
  for (const Verdict verdict :
       {Verdict::kNotConfirmed, Verdict::kInPart, Verdict::kOpen, Verdict::kConfirmed}) {
    const std::size_t before = claims.size();
    for (const ClaimFinding& found : findings.claims) {
      if (found.verdict == verdict) claims.push_back(&found);
    }
    if (claims.size() > before)
      verdicts +=
          fmt::format("{}{} {}", verdicts.empty() ? "" : ", ", claims.size() - before, text_of(verdict));
  }
  std::string text = fmt::format("{} claims of the paper: {}.\n", claims.size(), verdicts);
  text += fmt::format("{:<72} {:>9}  {}\n", "the paper", "confirmed", "verdict");
  std::string others;
  for (const ClaimFinding* found : claims) {
    text += fmt::format("{:<72} {:>9}  {}\n", found->claim.place + ": " + found->claim.says,
                        confirmed_text(*found), text_of(found->verdict));
    const std::vector<std::string> clauses = scene_clauses(*found);
    if (!clauses.empty()) text += fmt::format("  {}\n", fmt::join(clauses, ";\n  "));
    others += others_text(*found);
  }
  return others.empty() ? text : text + "Where the model does not confirm the paper:\n" + others;
}

}  // namespace stereotlm::paper
