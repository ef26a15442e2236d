#include "sw/stats/stats_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <tuple>
#include <type_traits>
#include <utility>

#include "models/fpga/core_ports.h"
#include "models/memory/bank_arbiter.h"
#include "platform/bounds.h"
#include "platform/computer_parts.h"
#include "platform/config/board_area.h"
#include "platform/config/buffer_layout.h"
#include "platform/figures.h"
#include "sw/files/text_forms.h"
#include "sw/stats/console_table.h"

namespace stereotlm::stats {
namespace {

using Json = nlohmann::ordered_json;
using Pointer = Json::json_pointer;

// A key of an object, and the member that holds its value.
template <typename Object, typename Value>
struct Field {
  const char* key;
  Value Object::*member;
};
template <typename Object, typename Value>
Field(const char*, Value Object::*) -> Field<Object, Value>;

// The keys of an object in stats.json, in their order.
constexpr auto fields_of(const platform::BankStatistics* /*type*/) {
  using Bank = platform::BankStatistics;
  return std::tuple(
      Field{"name", &Bank::name}, Field{"reads", &Bank::reads}, Field{"writes", &Bank::writes},
      Field{"busy_cycles", &Bank::busy_cycles}, Field{"turnaround_cycles", &Bank::turnaround_cycles},
      Field{"row_cycles", &Bank::row_cycles}, Field{"refresh_cycles", &Bank::refresh_cycles},
      Field{"idle_cycles", &Bank::idle_cycles}, Field{"contended_cycles", &Bank::contended_cycles},
      Field{"utilization", &Bank::utilization}, Field{"megabytes_per_second", &Bank::megabytes_per_second});
}
constexpr auto fields_of(const platform::PortStatistics* /*type*/) {
  using Port = platform::PortStatistics;
  return std::tuple(Field{"name", &Port::name}, Field{"grants", &Port::grants},
                    Field{"stall_cycles", &Port::stall_cycles}, Field{"passed_cycles", &Port::passed_cycles},
                    Field{"idle_cycles", &Port::idle_cycles}, Field{"blocked_cycles", &Port::blocked_cycles},
                    Field{"starved_cycles", &Port::starved_cycles});
}
constexpr auto fields_of(const platform::BlameRow* /*type*/) {
  using Row = platform::BlameRow;
  return std::tuple(Field{"port", &Row::port}, Field{"bank", &Row::bank}, Field{"by", &Row::by},
                    Field{"cycles", &Row::cycles});
}
constexpr auto fields_of(const platform::PciMasterStatistics* /*type*/) {
  using Master = platform::PciMasterStatistics;
  return std::tuple(Field{"name", &Master::name}, Field{"transactions", &Master::transactions},
                    Field{"words", &Master::words}, Field{"wait_clocks", &Master::wait_clocks});
}
constexpr auto fields_of(const platform::CameraStatistics* /*type*/) {
  using Camera = platform::CameraStatistics;
  return std::tuple(
      Field{"name", &Camera::name}, Field{"frames", &Camera::frames},
      Field{"captured_frames", &Camera::captured_frames}, Field{"dropped_frames", &Camera::dropped_frames},
      Field{"dropped_pixels", &Camera::dropped_pixels},
      Field{"dropped_not_armed", &Camera::dropped_not_armed}, Field{"dropped_busy", &Camera::dropped_busy},
      Field{"dropped_by_partner", &Camera::dropped_by_partner});
}
constexpr auto fields_of(const platform::Percentiles* /*type*/) {
  using Values = platform::Percentiles;
  return std::tuple(Field{"min", &Values::min}, Field{"p50", &Values::p50}, Field{"p95", &Values::p95},
                    Field{"p99", &Values::p99}, Field{"max", &Values::max});
}

// The fields of stats.json that hold figures, in their order. `document`: a StatsWriter or a StatsReader,
// which takes each field by its path. The fields of a computer are there if `statistics` has one.
template <typename Document, typename Statistics>
void each_field(Document& document, Statistics& statistics) {
  document.field("/board", statistics.board);
  document.field("/fidelity", statistics.fidelity);
  document.field("/frames", statistics.frames);
  document.field("/cycles", statistics.cycles);
  document.field("/frame_cycles", statistics.frame_cycles);
  auto& rate = statistics.frames_per_second;
  document.field("/frames_per_second/core", rate.core);
  if (rate.system) document.field("/frames_per_second/system", *rate.system);
  if (rate.steady) {
    document.field("/frames_per_second/steady", rate.steady->frames_per_second);
    document.field("/frames_per_second/steady_uncertainty", rate.steady->uncertainty);
  }
  auto& bound = statistics.bound;
  document.field("/bound/core", bound.core);
  document.field("/bound/core_limited_by", bound.core_limited_by);
  if (bound.system) {
    document.field("/bound/system", *bound.system);
    document.field("/bound/system_limited_by", bound.system_limited_by);
  }
  document.field("/banks", statistics.banks);
  document.field("/ports", statistics.ports);
  document.field("/blame", statistics.blame);
  if (!statistics.computer) return;
  auto& computer = *statistics.computer;
  document.field("/pci/clocks", computer.pci_clocks);
  document.field("/pci/busy_clocks", computer.pci_busy_clocks);
  document.field("/pci/masters", computer.pci_masters);
  document.field("/bridge/posted_words", computer.posted_words);
  document.field("/bridge/dma_words", computer.dma_words);
  document.field("/bridge/local_clocks", computer.local_clocks);
  document.field("/bridge/local_busy_clocks", computer.local_busy_clocks);
  document.field("/cameras", computer.cameras);
  document.field("/latency_ms/capture_to_host", computer.capture_to_host_ms);
}

// Whether the value is an object with fields_of().
template <typename Value, typename = void>
struct HasFields : std::false_type {};
template <typename Value>
struct HasFields<Value, std::void_t<decltype(fields_of(static_cast<const Value*>(nullptr)))>>
    : std::true_type {};

struct StatsWriter {
  template <typename Value>
  void field(const char* path, const Value& value) {
    document[Pointer(path)] = json_of(value);
  }
  template <typename Value>
  static Json json_of(const Value& value) {
    if constexpr (HasFields<Value>::value) {
      Json json = Json::object();
      std::apply([&](const auto&... field) { (add(json, field.key, value.*field.member), ...); },
                 fields_of(&value));
      return json;
    } else {
      return value;
    }
  }
  template <typename Value>
  static Json json_of(const std::vector<Value>& values) {
    Json json = Json::array();
    for (const Value& value : values) json.push_back(json_of(value));
    return json;
  }

  template <typename Value>
  static void add(Json& object, const char* key, const Value& value) {
    object[key] = value;
  }
  // A value that not every object has.
  template <typename Value>
  static void add(Json& object, const char* key, const std::optional<Value>& value) {
    if (value) object[key] = *value;
  }

  Json document = {{"schema", 1}};
};

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

  template <typename Value>
  void field(const char* path, Value& value) const {
    read(Pointer(path), value);
  }
  // The value at this path.
  template <typename Value>
  void read(const Pointer& path, Value& value) const {
    if constexpr (HasFields<Value>::value) {
      std::apply([&](const auto&... field) { (read(path / field.key, value.*field.member), ...); },
                 fields_of(&value));
      return;
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
    if (has(path)) read(path, value.emplace());
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

// The figures of an accuracy, by their keys.
template <typename Accuracies>
auto percents_of(Accuracies& accuracy) {
  return std::array{std::pair("bad_1_percent", &accuracy.bad_1_percent),
                    std::pair("bad_2_percent", &accuracy.bad_2_percent),
                    std::pair("answered_percent", &accuracy.answered_percent)};
}

std::optional<Accuracy> read_accuracy(const StatsReader& reader) {
  if (!reader.has(Pointer("/accuracy"))) return std::nullopt;
  Accuracy accuracy;
  for (const auto& [key, percent] : percents_of(accuracy)) {
    const Pointer path = Pointer("/accuracy") / key;
    if (!reader.has(path)) continue;
    reader.read(path, percent->emplace());
    if (**percent > 100) reader.refuse(path, "must be at most 100");
  }
  return accuracy;
}

// Every value by its path. Paths are sorted as text: entry 10 of a list comes before entry 2.
std::map<std::string, std::string> values_of(const std::string& text) {
  std::map<std::string, std::string> values;
  const nlohmann::json flat = nlohmann::json(files::parse_json(text)).flatten();
  for (const auto& [path, value] : flat.items()) values[path] = value.dump();
  return values;
}

}  // namespace

Json area_json(const area::Area& area) {
  Json json = {{"slices", area.slices},
               {"slices_percent", area.slices_percent},
               {"luts", area.luts},
               {"flip_flops", area.flip_flops},
               {"block_rams", area.block_rams},
               {"block_rams_percent", area.block_rams_percent},
               {"multipliers", area.multipliers},
               {"multipliers_percent", area.multipliers_percent}};
  if (area.pins) json["pins"] = *area.pins;
  if (area.pins_percent) json["pins_percent"] = *area.pins_percent;
  return json;
}

Json area_json(const platform::BoardConfig& board) {
  const area::Area area = platform::area_of(board);
  Json json = area_json(area);
  json["fits"] = area.fits();
  return json;
}

Json area_document(const platform::BoardConfig& board) {
  Json json = area_json(board);
  json["device"] = platform::device_of(board).name;
  if (const area::Device* const smallest = area::smallest_device(platform::area_of(board)))
    json["smallest_device"] = smallest->name;
  Json& parts = json["parts"] = Json::array();
  for (const area::Item& item : platform::area_items(board)) {
    parts.push_back({{"name", item.name},
                     {"count", item.count},
                     {"luts", item.all.luts},
                     {"flip_flops", item.all.flip_flops},
                     {"block_rams", item.all.block_rams},
                     {"multipliers", item.all.multipliers}});
  }
  return json;
}

Json stats_document(const platform::Statistics& statistics, const std::optional<Accuracy>& accuracy) {
  StatsWriter writer;
  each_field(writer, statistics);
  Json& document = writer.document;
  document["area"] = area_json(statistics.area);
  if (!statistics.failed.empty()) document["failed"] = statistics.failed;
  if (!accuracy) return document;
  Json& percents = document["accuracy"] = Json::object();
  for (const auto& [key, percent] : percents_of(*accuracy)) {
    if (*percent) percents[key] = **percent;
  }
  return document;
}

nlohmann::ordered_json run_document(const platform::Statistics& statistics, const TableExtras& extras) {
  Json document = stats_document(statistics, extras.accuracy);
  if (extras.waitless_frames_per_second)
    document["waitless_frames_per_second"] = *extras.waitless_frames_per_second;
  if (extras.answered_percent) document["disparities_percent"] = *extras.answered_percent;
  return document;
}

std::string stats_json(const platform::Statistics& statistics, const std::optional<Accuracy>& accuracy) {
  return files::json_text(stats_document(statistics, accuracy));
}

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
  }
  each_field(reader, statistics);
  if (frames == 0 || statistics.frame_cycles.size() != frames)
    reader.refuse(Pointer("/frame_cycles"),
                  fmt::format("must have an entry for each of the {} frames of run.json", frames));
  statistics.fidelity = fidelity;
  statistics.banks.resize(board.banks.size());
  statistics.ports.resize(platform::core_ports(board).size());
  platform::derive_figures(board, statistics);
  check_names(reader, board, statistics);
  const Json right = stats_document(statistics, read_accuracy(reader));
  reader.expect(right);
  StatsReader::check_same(text, files::json_text(right));
  platform::Audit audit;
  platform::audit_core(statistics, audit);
  platform::audit_accesses(board, statistics, audit);
  if (statistics.computer) platform::audit_computer(*statistics.computer, audit);
  reader.check(audit);
  return statistics;
}

std::vector<std::string> stats_differences(const std::string& first, const std::string& second,
                                           const std::string& first_name, const std::string& second_name) {
  const auto firsts = values_of(first);
  const auto seconds = values_of(second);
  const auto value = [](const auto& values, const std::string& path) {
    const auto found = values.find(path);
    return found == values.end() ? std::string("absent") : found->second;
  };
  auto paths = firsts;
  paths.insert(seconds.begin(), seconds.end());
  std::vector<std::string> lines;
  for (const auto& [path, unused] : paths) {
    const std::string one = value(firsts, path);
    const std::string other = value(seconds, path);
    if (one != other)
      lines.push_back(fmt::format("{}: {} {}, {} {}", path, first_name, one, second_name, other));
  }
  return lines;
}

}  // namespace stereotlm::stats
