#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <variant>

#include "platform/config/board_yaml.h"
#include "sw/paper/document.h"

namespace stereotlm::paper {
namespace {

std::string cell(double value) { return fmt::format("{}", value); }
std::string cell(std::int64_t value) { return fmt::format("{}", value); }
std::string cell(const std::optional<double>& value) { return value ? cell(*value) : ""; }
std::string cell(const std::optional<std::uint64_t>& value) { return value ? fmt::format("{}", *value) : ""; }
std::string cell(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char each : text) quoted += each == '"' ? std::string("\"\"") : std::string(1, each);
  return quoted + '"';
}

template <typename... Cells>
std::string row(const Cells&... cells) {
  std::string text;
  ((text += (text.empty() ? "" : ",") + cell(cells)), ...);
  return text + '\n';
}

std::string command_text(const Claim& claim, const Case& one) {
  return fmt::format("{}", fmt::join(commands_of(claim, one), " && "));
}

// The keys that a table has columns for, which describe its boards.
constexpr std::array kBoardKeys = {"image.width",         "image.height",   "matcher.window",
                                   "matcher.disparities", "matcher.filter", "fpga.clock_mhz",
                                   "fpga.device"};

std::string board_header() { return fmt::format(",{}\n", fmt::join(kBoardKeys, ",")); }

// Appends to a row the values of kBoardKeys for the board of a run.
std::string with_board(std::string row, const BoardRun& run) {
  row.pop_back();  // the newline
  const auto values = platform::values_of(board_of(run));
  for (const char* const key : kBoardKeys) {
    const auto is_it = [key](const platform::BoardValue& value) { return value.path == key; };
    const auto found = std::find_if(values.begin(), values.end(), is_it);
    row += ',' + std::visit([](const auto& value) { return cell(value); }, found->value);
  }
  return row + '\n';
}

// The number at the beginning of the name of a case: 7 in "7x7", 80 in "80 disparities".
std::string leading_number(const std::string& name) {
  return name.substr(0, name.find_first_not_of("0123456789"));
}

std::string table1(const Findings& findings) {
  const ClaimFinding& found = findings.of("table1");
  std::string text =
      "window,paper_frames_per_second,paper_half_digit,model_frames_per_second,bound_frames_per_second,"
      "limited_by,deviation_percent,rule,tolerance_percent,verdict,clock_mhz_least,clock_mhz_most,"
      "model_log7_frames_per_second,command" +
      board_header();
  for (const CaseFinding& finding : found.cases) {
    const Case& one = finding.of;
    const Measured& run = finding.runs.front();
    const auto clock = clock_for(found.claim, finding);
    text += with_board(
        row(leading_number(one.name), one.printed, found.claim.half_digit, finding.modelled, run.bound,
            run.limited_by, deviation_percent(found.claim, finding), text_of(found.claim.rule),
            found.claim.rule.tolerance, text_of(finding.verdict), clock->least_mhz, clock->most_mhz,
            finding.runs.at(1).rate, command_text(found.claim, one)),
        one.runs.front());
  }
  return text;
}

std::string table2(const Findings& findings) {
  const ClaimFinding& size = findings.of("table2_size");
  const ClaimFinding& rate = findings.of("table2_rate");
  std::string text =
      "disparities,paper_slices_percent,paper_slices_percent_least,paper_slices_percent_most,"
      "model_slices_percent,error_points,size_rule,size_tolerance_points,size_verdict,"
      "paper_frames_per_second,model_frames_per_second,bound_frames_per_second,limited_by,"
      "deviation_percent,rate_rule,rate_verdict,size_command,rate_command" +
      board_header();
  for (std::size_t i = 0; i < size.cases.size(); ++i) {
    const Case& area = size.cases[i].of;
    const Case& speed = rate.cases[i].of;
    const Measured& run = rate.cases[i].runs.front();
    text += with_board(
        row(leading_number(area.name), area.printed, area.printed - size.claim.half_digit,
            area.printed + size.claim.half_digit, size.cases[i].modelled,
            size.cases[i].modelled - area.printed, text_of(size.claim.rule), size.claim.rule.tolerance,
            text_of(size.cases[i].verdict), speed.printed, rate.cases[i].modelled, run.bound, run.limited_by,
            deviation_percent(rate.claim, rate.cases[i]), text_of(rate.claim.rule),
            text_of(rate.cases[i].verdict), command_text(size.claim, area), command_text(rate.claim, speed)),
        area.runs.front());
  }
  return text;
}

std::string banks(const Findings& findings) {
  std::string text =
      "claim,banks,allocations,frames_per_second,delivered_frames_per_second,bound_frames_per_second,"
      "limited_by,reached_by,allocation,command" +
      board_header();
  for (const BankRow& one : findings.banks) {
    text += with_board(
        row(one.of, fmt::format("{}", one.banks), one.allocations, one.measured.rate, one.measured.delivered,
            one.measured.bound, one.measured.limited_by, one.reached_by, one.allocation, one.command),
        findings.of(one.of).claim.cases.front().runs.front());
  }
  return text;
}

std::string costs(const Findings& findings) {
  std::string text =
      "scene,cost,wrong_percent,answered_percent,wrong_change_points,answered_change_points,slices_percent,"
      "verdict,command\n";
  for (const CostRow& one : cost_rows(findings.of("costs"))) {
    text += row(one.scene, one.cost, one.quality.wrong_percent, one.quality.answered_percent,
                one.change.wrong_percent, one.change.answered_percent, one.slices_percent,
                one.verdict ? text_of(*one.verdict) : std::string(), one.command);
  }
  return text;
}

std::string all_claims(const Findings& findings) {
  std::string text =
      "claim,place,says,case,unit,paper,half_digit,model,bound,limited_by,deviation_percent,rule,tolerance,"
      "verdict,clock_mhz_least,clock_mhz_most,claim_verdict,command\n";
  for (const ClaimFinding& found : findings.claims) {
    for (const CaseFinding& finding : found.cases) {
      const Case& one = finding.of;
      const bool is_rate = found.claim.quantity == Quantity::kRate;
      const auto clock = clock_for(found.claim, finding);
      const auto of_clock = [&](double ClockRange::*mhz) {
        return clock ? std::optional<double>((*clock).*mhz) : std::nullopt;
      };
      const auto of_paper = [&](double value) {
        const bool is_printed = found.claim.quantity != Quantity::kAccuracyChange;
        return is_printed ? std::optional<double>(value) : std::nullopt;
      };
      text +=
          row(found.claim.name, found.claim.place, found.claim.says, one.name, unit_of(found.claim.quantity),
              of_paper(one.printed), of_paper(found.claim.half_digit), finding.modelled,
              is_rate ? std::optional<double>(finding.runs.front().bound) : std::nullopt,
              is_rate ? finding.runs.front().limited_by : std::string(),
              deviation_percent(found.claim, finding), text_of(found.claim.rule), found.claim.rule.tolerance,
              text_of(finding.verdict), of_clock(&ClockRange::least_mhz), of_clock(&ClockRange::most_mhz),
              text_of(found.verdict), command_text(found.claim, one));
    }
  }
  return text;
}

}  // namespace

std::map<std::string, std::string> tables(const Findings& findings) {
  return {{"table1.csv", table1(findings)},
          {"table2.csv", table2(findings)},
          {"banks.csv", banks(findings)},
          {"costs.csv", costs(findings)},
          {"claims.csv", all_claims(findings)}};
}

}  // namespace stereotlm::paper
