#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <type_traits>

#include "models/fpga/core_ports.h"
#include "models/memory/bank_arbiter.h"
#include "platform/config/buffer_layout.h"
#include "platform/config/computer_parts.h"
#include "platform/figures/bounds.h"
#include "platform/figures/derived_figures.h"
#include "sw/files/text_forms.h"
#include "sw/stats/stats_fields.h"
#include "sw/stats/stats_json.h"

namespace stereotlm::stats {
namespace {

// Reads a document of stats.json. Throws std::runtime_error: "LINE: path = value: rule".
class StatsReader {
 public:
  explicit StatsReader(const std::string& text) {
    try {
      document_ = files::parse_json(text);
    } catch (const files::JsonError& error) {
      throw std::runtime_error(fmt::format("{}: must be as run writes it: {}", error.line, error.what()));
    }
    if (!document_.is_object()) throw std::runtime_error("1: must be as run writes it: a JSON object");
    check_same(text, files::json_text(document_));
  }

  // Throws at the first difference if the text is not the right one.
  static void check_same(const std::string& text, const std::string& right) {
    if (text == right) return;
    const auto at = std::mismatch(text.begin(), text.end(), right.begin(), right.end()).first;
    throw std::runtime_error(fmt::format(
        "{}: must be as run writes it: keys in their order, each once; numbers and spaces in the same form",
        line_at(text, static_cast<std::size_t>(at - text.begin()))));
  }

  bool has(const Pointer& path) const { return document_.contains(path); }

  // Reads the value at this path. What an object leaves out stays as it is; but a member that has a value
  // must be there.
  template <typename Value>
  void read(const Pointer& path, Value& value) const {
    if constexpr (HasFields<Value>::value) {
      each_value(value, path, [&](const Pointer& its_path, const auto& field, auto& its) {
        if (!is_left_out(field, its) || has(its_path)) read(its_path, its);
      });
    } else {
      const Json& json = at(path);
      if constexpr (std::is_same_v<Value, std::string>) {
        if (!json.is_string()) refuse(path, "must be a text");
      } else if constexpr (std::is_same_v<Value, double>) {
        if (!json.is_number() || json.get<double>() < 0)
          refuse(path, "must be a number that is not negative");
      } else if (!json.is_number_unsigned() || json.get<std::uint64_t>() > INT64_MAX) {
        refuse(path, fmt::format("must be an integer of 0..{}", INT64_MAX));
      }
      value = json.get<Value>();
    }
  }
  template <typename Value>
  void read(const Pointer& path, std::optional<Value>& value) const {
    read(path, value ? *value : value.emplace());
  }
  template <typename Value>
  void read(const Pointer& path, std::vector<Value>& values) const {
    if (!at(path).is_array()) refuse(path, "must be a list");
    values.resize(at(path).size());
    for (std::size_t index = 0; index < values.size(); ++index) read(path / index, values[index]);
  }

  // Refuses the first value that differs from `right`, which follows from the other values.
  void expect(const Json& right) const {
    const Json differences = Json::diff(document_, right);
    if (differences.empty()) return;
    const std::string kind = differences[0].at("op");
    const Pointer path(differences[0].at("path").get<std::string>());
    if (kind == "remove") refuse(path, "must be left out");
    if (kind == "add") {
      const Pointer list = path.parent_pointer();
      at(path.back() == "-" ? list / at(list).size() : path);
    }
    refuse(path,
           fmt::format("must be {}, which follows from other figures and the board", right.at(path).dump()));
  }
  // Throws if an identity does not hold. Its message begins with its subject: "bank bank0: ..", "pci: ..".
  void check(const platform::Audit& audit) const {
    if (audit.failed().empty()) return;
    const std::string& text = audit.failed().front();
    const std::string subject = text.substr(0, text.find(':'));
    const std::size_t space = subject.find(' ');
    Pointer path = Pointer() / subject;
    if (space != std::string::npos) {
      path = Pointer() / (subject.substr(0, space) + 's');
      std::size_t index = 0;
      while (at(path / index / "name") != subject.substr(space + 1)) ++index;
      path /= index;
    }
    throw std::runtime_error(fmt::format("{}: {}", line_of(path), text));
  }

  // The index of a text among the names.
  std::size_t index(const Pointer& path, const std::string& text,
                    const std::vector<std::string>& names) const {
    const auto found = std::find(names.begin(), names.end(), text);
    if (found == names.end()) refuse(path, fmt::format("must be one of {}", fmt::join(names, ", ")));
    return static_cast<std::size_t>(found - names.begin());
  }

  [[noreturn]] void refuse(const Pointer& path, const std::string& rule) const {
    constexpr std::size_t kMostLetters = 80;
    std::string value = document_.at(path).dump();
    if (value.size() > kMostLetters) value = value.substr(0, kMostLetters) + "..";
    throw std::runtime_error(fmt::format("{}: {} = {}: {}", line_of(path), name_of(path), value, rule));
  }

 private:
  static std::ptrdiff_t line_at(const std::string& text, std::size_t byte) {
    const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(byte, text.size()));
    return 1 + std::count(text.begin(), end, '\n');
  }

  const Json& at(const Pointer& path) const {
    if (document_.contains(path)) return document_.at(path);
    at(path.parent_pointer());
    throw std::runtime_error(fmt::format("{}: {}: missing: must be as run writes it",
                                         line_of(path.parent_pointer()), name_of(path)));
  }

  // "banks.0.reads" of "/banks/0/reads"
  static std::string name_of(const Pointer& path) {
    if (path.empty()) return "";
    const std::string above = name_of(path.parent_pointer());
    return above.empty() ? path.back() : above + '.' + path.back();
  }

  // The area follows from the board.
  void read(const Pointer& /*path*/, area::Area& /*area*/) const {}

  // The line of a value, in the form of json_text().
  std::ptrdiff_t line_of(const Pointer& path) const {
    if (path.empty()) return 1;
    const std::string mark = "the value of which the line is asked";
    Json marked = document_;
    Json& value = marked.at(path);
    value = value.is_structured() && !value.empty() ? Json::array({mark, Json::array()}) : Json(mark);
    const std::string text = files::json_text(marked);
    return line_at(text, text.find(mark)) - (value.is_array() ? 1 : 0);
  }

  Json document_;
};

// Checks the names of blame and of what limits, and sets those of the computer.
void check_names(const StatsReader& reader, const platform::BoardConfig& board,
                 platform::Statistics& statistics) {
  std::vector<std::string> banks;
  for (const platform::BankConfig& bank : board.banks) banks.push_back(bank.name);
  std::vector<std::string> ports;
  const fpga::CorePorts all_ports = platform::core_ports(board);
  for (std::size_t port = 0; port < all_ports.size(); ++port) ports.push_back(all_ports.name(port));
  std::vector<std::string> causes = ports;
  for (std::size_t cause = memory::kTurnaround; cause <= memory::kRefresh; ++cause)
    causes.emplace_back(memory::name_of_cause(cause));
  std::array<std::size_t, 3> last{};
  const auto accesses = platform::core_accesses(board, statistics);
  const bool is_exact = platform::stripes_of(board).empty();  // of the accesses
  for (std::size_t row = 0; row < statistics.blame.size(); ++row) {
    const Pointer path = Pointer("/blame") / row;
    const platform::BlameRow& blame = statistics.blame[row];
    const std::array<std::size_t, 3> cause = {reader.index(path / "port", blame.port, ports),
                                              reader.index(path / "bank", blame.bank, banks),
                                              reader.index(path / "by", blame.by, causes)};
    if (is_exact && cause[0] < accesses.size() && accesses[cause[0]][cause[1]] == 0)
      reader.refuse(path / "bank", "must be a bank that the port accesses");
    if (blame.cycles == 0) reader.refuse(path / "cycles", "must be 1 or more");
    if (row != 0 && cause <= last) reader.refuse(path, "must follow the row before, by port, bank and by");
    last = cause;
  }
  std::vector<std::string> limits = {"matcher"};
  for (const std::string& port : ports) limits.push_back("port " + port);
  for (const std::string& bank : banks) limits.push_back(platform::resource_of_bank(bank));
  reader.index(Pointer("/bound/core_limited_by"), statistics.bound.core_limited_by, limits);
  if (!statistics.computer) return;
  for (const char* around : {"camera", "pci", "bridge"}) limits.emplace_back(around);
  reader.index(Pointer("/bound/system_limited_by"), statistics.bound.system_limited_by, limits);
  statistics.computer->cameras.resize(2);
  statistics.computer->cameras[0].name = "left";
  statistics.computer->cameras[1].name = "right";
  auto& masters = statistics.computer->pci_masters;
  masters.resize(platform::kPciMasterNames.size() - (board.pci.load ? 0 : 1));
  for (std::size_t master = 0; master < masters.size(); ++master)
    masters[master].name = platform::kPciMasterNames[master];
}

std::optional<Accuracy> read_accuracy(const StatsReader& reader) {
  if (!reader.has(Pointer("/accuracy"))) return std::nullopt;
  Accuracy accuracy;
  reader.read(Pointer("/accuracy"), accuracy);
  each(fields_of(&accuracy), [&](const auto& field) {
    if ((accuracy.*field.member).value_or(0) > 100)
      reader.refuse(Pointer("/accuracy") / field.key, "must be at most 100");
  });
  return accuracy;
}

}  // namespace

platform::Statistics read_stats(const std::string& text, const platform::BoardConfig& board,
                                const std::string& fidelity, std::uint64_t frames, bool camera) {
  const StatsReader reader(text);
  if (reader.has(Pointer("/failed")))
    reader.refuse(Pointer("/failed"), "must be a run in which nothing failed");
  platform::Statistics statistics;
  if (camera) {
    statistics.frames_per_second.system.emplace();
    statistics.bound.system.emplace();
    statistics.computer.emplace();
    if (reader.has(Pointer("/frames_per_second/steady")))
      statistics.frames_per_second.steady.emplace().frames =
          platform::steady_frames(frames, platform::allocation_period_frames(board));
    if (reader.has(Pointer("/frames_per_second/exact_least"))) {
      platform::ProvenRate& proven = statistics.frames_per_second.proven.emplace();
      if (reader.has(Pointer("/frames_per_second/exact"))) {
        proven.exact.emplace();
        proven.deliveries.emplace();
        proven.camera_frames.emplace();
      }
    }
  }
  reader.read(Pointer(), statistics);
  if (camera) {
    reader.read(Pointer("/bound/system_limited_by"), statistics.bound.system_limited_by);
  } else {
    statistics.frames_per_second.system = statistics.bound.system = std::nullopt;
    statistics.bound.system_limited_by.clear();
  }
  if (frames == 0 || statistics.frame_cycles.size() != frames)
    reader.refuse(Pointer("/frame_cycles"),
                  fmt::format("must have an entry for each of the {} frames of run.json", frames));
  statistics.fidelity = fidelity;
  statistics.banks.resize(board.banks.size());
  statistics.ports.resize(platform::core_ports(board).size());
  platform::derive_figures(board, statistics);
  platform::derive_energy(board, statistics);
  check_names(reader, board, statistics);
  const Json right = stats_document(statistics, read_accuracy(reader));
  reader.expect(right);
  StatsReader::check_same(text, files::json_text(right));
  platform::Audit audit;
  platform::audit_core(statistics, audit);
  platform::audit_accesses(board, statistics, audit);
  platform::audit_energy(statistics, audit);
  if (statistics.computer) platform::audit_computer(*statistics.computer, audit);
  reader.check(audit);
  return statistics;
}

}  // namespace stereotlm::stats
