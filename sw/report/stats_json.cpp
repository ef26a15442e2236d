#include "sw/report/stats_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "models/fpga/core_ports.h"
#include "platform/computer_parts.h"
#include "platform/figures.h"
#include "sw/files/json_text.h"
#include "sw/report/console_table.h"

namespace stereotlm::report {
namespace {

using Json = nlohmann::ordered_json;

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

template <typename Object>
Json to_json(const Object& object) {
  Json result = Json::object();
  std::apply([&](const auto&... field) { ((result[field.key] = object.*field.member), ...); },
             fields_of(&object));
  return result;
}

Json to_json(const Accuracy& accuracy) {
  Json result = Json::object();
  const auto add = [&result](const char* key, const std::optional<double>& percent) {
    if (percent) result[key] = *percent;
  };
  add("bad_1_percent", accuracy.bad_1_percent);
  add("bad_2_percent", accuracy.bad_2_percent);
  add("answered_percent", accuracy.answered_percent);
  return result;
}

template <typename Row>
Json rows(const std::vector<Row>& values) {
  Json result = Json::array();
  for (const Row& value : values) result.push_back(to_json(value));
  return result;
}

void add_computer(const platform::ComputerStatistics& computer, Json& document) {
  document["pci"] = {{"clocks", computer.pci_clocks},
                     {"busy_clocks", computer.pci_busy_clocks},
                     {"masters", rows(computer.pci_masters)}};
  document["bridge"] = {{"posted_words", computer.posted_words},
                        {"dma_words", computer.dma_words},
                        {"local_clocks", computer.local_clocks},
                        {"local_busy_clocks", computer.local_busy_clocks}};
  document["cameras"] = rows(computer.cameras);
  document["latency_ms"] = {{"capture_to_host", to_json(computer.capture_to_host_ms)}};
}

// Reads a document of stats.json. Throws std::runtime_error: "LINE: path = value: rule".
class StatsReader {
 public:
  explicit StatsReader(const std::string& text) {
    try {
      document_ = Json::parse(text);
    } catch (const Json::exception& error) {
      const auto* const syntax = dynamic_cast<const Json::parse_error*>(&error);
      throw std::runtime_error(fmt::format("{}: must be as run writes it: {}",
                                           line_at(text, syntax == nullptr ? 0 : syntax->byte),
                                           error.what()));
    }
    if (!document_.is_object()) throw std::runtime_error("1: must be as run writes it: a JSON object");
    check_form(text);
  }

  // Throws at the first difference if the text is not that of the document.
  void check_form(const std::string& text) const { check_same(text, files::json_text(document_)); }
  static void check_same(const std::string& text, const std::string& right) {
    if (text == right) return;
    const auto at = std::mismatch(text.begin(), text.end(), right.begin(), right.end()).first;
    throw std::runtime_error(fmt::format(
        "{}: must be as run writes it: keys in their order, each once; numbers and spaces in the same form",
        line_at(text, static_cast<std::size_t>(at - text.begin()))));
  }

  const Json& document() const { return document_; }
  bool has(const char* path) const { return document_.contains(Pointer(path)); }

  // The value at this path.
  template <typename Value>
  void read(const std::string& path, Value& value) const {
    const Json& json = at(path);
    if constexpr (std::is_same_v<Value, std::string>) {
      if (!json.is_string()) refuse(path, "must be a text");
    } else if constexpr (std::is_same_v<Value, double>) {
      if (!json.is_number() || json.get<double>() < 0) refuse(path, "must be a number that is not negative");
    } else if (!json.is_number_unsigned() || json.get<std::uint64_t>() > INT64_MAX) {
      refuse(path, fmt::format("must be an integer of 0..{}", INT64_MAX));
    }
    value = json.get<Value>();
  }
  template <typename Object>
  void read_fields(const std::string& path, Object& object) const {
    std::apply([&](const auto&... field) { (read(path + '/' + field.key, object.*field.member), ...); },
               fields_of(&object));
  }
  // The entries of a list, each of which `read_entry` reads.
  template <typename Entry, typename ReadEntry>
  void read_list(const std::string& path, std::vector<Entry>& entries, const ReadEntry& read_entry) const {
    if (!at(path).is_array()) refuse(path, "must be a list");
    entries.resize(at(path).size());
    for (std::size_t index = 0; index < entries.size(); ++index)
      read_entry(path + '/' + std::to_string(index), entries[index]);
  }
  template <typename Object>
  void read_objects(const std::string& path, std::vector<Object>& objects) const {
    read_list(path, objects,
              [this](const std::string& entry, Object& object) { read_fields(entry, object); });
  }

  // Refuses the first value that differs from `right`, which follows from the other values.
  void expect(const Json& right, const std::string& path = "") const {
    const Json& found = document_.at(Pointer(path));
    if (!found.is_structured() || found.type() != right.type()) {
      if (found != right)
        refuse(path, fmt::format("must be {}, which follows from other figures and the board", right.dump()));
      return;
    }
    for (const auto& [key, value] : found.items()) {
      const std::string below = path + '/' + key;
      const Json* const expected = entry_of(right, key);
      if (expected == nullptr) refuse(below, "must be left out");
      expect(*expected, below);
    }
    for (const auto& [key, value] : right.items()) at(path + '/' + key);
  }
  // Throws if an identity does not hold. Its message begins with its subject: "bank bank0: ..", "pci: ..".
  void check(const platform::Audit& audit) const {
    if (audit.failed().empty()) return;
    const std::string& text = audit.failed().front();
    const std::string subject = text.substr(0, text.find(':'));
    const std::size_t space = subject.find(' ');
    std::string path = '/' + subject;
    if (space != std::string::npos) {
      path = '/' + subject.substr(0, space) + "s/";
      std::size_t index = 0;
      while (at(path + std::to_string(index) + "/name") != subject.substr(space + 1)) ++index;
      path += std::to_string(index);
    }
    throw std::runtime_error(fmt::format("{}: {}", line_of(path), text));
  }

  // The index of a text among the names.
  std::size_t index(const std::string& path, const std::string& text,
                    const std::vector<std::string>& names) const {
    const auto found = std::find(names.begin(), names.end(), text);
    if (found == names.end()) refuse(path, fmt::format("must be one of {}", fmt::join(names, ", ")));
    return static_cast<std::size_t>(found - names.begin());
  }

  [[noreturn]] void refuse(const std::string& path, const std::string& rule) const {
    constexpr std::size_t kMostLetters = 80;
    std::string value = document_.at(Pointer(path)).dump();
    if (value.size() > kMostLetters) value = value.substr(0, kMostLetters) + "..";
    throw std::runtime_error(fmt::format("{}: {} = {}: {}", line_of(path), name_of(path), value, rule));
  }

 private:
  using Pointer = Json::json_pointer;

  static std::ptrdiff_t line_at(const std::string& text, std::size_t byte) {
    const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(byte, text.size()));
    return 1 + std::count(text.begin(), end, '\n');
  }

  // Null if there is none.
  static const Json* entry_of(const Json& json, const std::string& key) {
    const Pointer pointer("/" + key);
    return json.contains(pointer) ? &json.at(pointer) : nullptr;
  }

  const Json& at(const std::string& path) const {
    if (document_.contains(Pointer(path))) return document_.at(Pointer(path));
    const std::size_t slash = path.rfind('/');
    at(path.substr(0, slash));
    throw std::runtime_error(fmt::format("{}: {}: missing: must be as run writes it",
                                         line_of(path.substr(0, slash)), name_of(path)));
  }

  // "banks.0.reads" of "/banks/0/reads"
  static std::string name_of(const std::string& path) {
    std::string name = path.substr(std::min<std::size_t>(1, path.size()));
    std::replace(name.begin(), name.end(), '/', '.');
    return name;
  }

  // The line of a value, in the form of json_text().
  std::ptrdiff_t line_of(const std::string& path) const {
    if (path.empty()) return 1;
    const std::string mark = "the value of which the line is asked";
    Json marked = document_;
    Json& value = marked.at(Pointer(path));
    value = value.is_structured() && !value.empty() ? Json::array({mark, Json::array()}) : Json(mark);
    const std::string text = files::json_text(marked);
    return line_at(text, text.find(mark)) - (value.is_array() ? 1 : 0);
  }

  Json document_;
};

void read_computer(const StatsReader& reader, platform::Statistics& statistics) {
  statistics.frames_per_second.system.emplace();
  reader.read("/frames_per_second/system", *statistics.frames_per_second.system);
  if (reader.has("/frames_per_second/steady")) {
    platform::SteadyRate& steady = statistics.frames_per_second.steady.emplace();
    reader.read("/frames_per_second/steady", steady.frames_per_second);
    reader.read("/frames_per_second/steady_uncertainty", steady.uncertainty);
  }
  statistics.bound.system.emplace();
  reader.read("/bound/system", *statistics.bound.system);
  reader.read("/bound/system_limited_by", statistics.bound.system_limited_by);
  platform::ComputerStatistics& computer = statistics.computer.emplace();
  reader.read("/pci/clocks", computer.pci_clocks);
  reader.read("/pci/busy_clocks", computer.pci_busy_clocks);
  reader.read_objects("/pci/masters", computer.pci_masters);
  reader.read("/bridge/posted_words", computer.posted_words);
  reader.read("/bridge/dma_words", computer.dma_words);
  reader.read("/bridge/local_clocks", computer.local_clocks);
  reader.read("/bridge/local_busy_clocks", computer.local_busy_clocks);
  reader.read_objects("/cameras", computer.cameras);
  reader.read_fields("/latency_ms/capture_to_host", computer.capture_to_host_ms);
}

// Checks the names of blame and of what limits, and sets those of the computer.
void check_names(const StatsReader& reader, const platform::BoardConfig& board,
                 platform::Statistics& statistics) {
  std::vector<std::string> banks;
  for (const platform::BankConfig& bank : board.banks) banks.push_back(bank.name);
  std::vector<std::string> ports;
  for (const fpga::CorePort& port : fpga::kPorts) ports.emplace_back(port.name);
  std::vector<std::string> causes = ports;
  causes.emplace_back("turnaround");
  std::array<std::size_t, 3> last{};
  const auto accesses = platform::core_accesses(board, statistics);
  for (std::size_t row = 0; row < statistics.blame.size(); ++row) {
    const std::string path = "/blame/" + std::to_string(row);
    const platform::BlameRow& blame = statistics.blame[row];
    const std::array<std::size_t, 3> cause = {reader.index(path + "/port", blame.port, ports),
                                              reader.index(path + "/bank", blame.bank, banks),
                                              reader.index(path + "/by", blame.by, causes)};
    if (cause[0] < accesses.size() && accesses[cause[0]][cause[1]] == 0)
      reader.refuse(path + "/bank", "must be a bank that the port accesses");
    if (blame.cycles == 0) reader.refuse(path + "/cycles", "must be 1 or more");
    if (row != 0 && cause <= last) reader.refuse(path, "must follow the row before, by port, bank and by");
    last = cause;
  }
  std::vector<std::string> limits = {"matcher"};
  for (const std::string& port : ports) limits.push_back("port " + port);
  for (const std::string& bank : banks) limits.push_back("bank " + bank);
  reader.index("/bound/core_limited_by", statistics.bound.core_limited_by, limits);
  if (!statistics.computer) return;
  for (const char* around : {"camera", "pci", "bridge"}) limits.emplace_back(around);
  reader.index("/bound/system_limited_by", statistics.bound.system_limited_by, limits);
  statistics.computer->cameras.resize(2);
  statistics.computer->cameras[0].name = "left";
  statistics.computer->cameras[1].name = "right";
  auto& masters = statistics.computer->pci_masters;
  masters.resize(platform::kPciMasterNames.size() - (board.pci.load ? 0 : 1));
  for (std::size_t master = 0; master < masters.size(); ++master)
    masters[master].name = platform::kPciMasterNames[master];
}

std::optional<Accuracy> read_accuracy(const StatsReader& reader) {
  if (!reader.has("/accuracy")) return std::nullopt;
  Accuracy accuracy;
  for (const auto& [key, percent] : {std::pair("/accuracy/bad_1_percent", &accuracy.bad_1_percent),
                                     std::pair("/accuracy/bad_2_percent", &accuracy.bad_2_percent),
                                     std::pair("/accuracy/answered_percent", &accuracy.answered_percent)}) {
    if (!reader.has(key)) continue;
    reader.read(key, percent->emplace());
    if (**percent > 100) reader.refuse(key, "must be at most 100");
  }
  return accuracy;
}

}  // namespace

Json area_json(const area::Area& area) {
  return {{"slices", area.slices},
          {"slices_percent", area.slices_percent},
          {"luts", area.luts},
          {"flip_flops", area.flip_flops},
          {"block_rams", area.block_rams},
          {"block_rams_percent", area.block_rams_percent},
          {"multipliers", area.multipliers},
          {"multipliers_percent", area.multipliers_percent}};
}

Json stats_document(const platform::Statistics& statistics, const std::optional<Accuracy>& accuracy) {
  Json document = {{"schema", 1},
                   {"board", statistics.board},
                   {"fidelity", statistics.fidelity},
                   {"frames", statistics.frames},
                   {"cycles", statistics.cycles},
                   {"frame_cycles", statistics.frame_cycles}};
  Json& rate = document["frames_per_second"] = {{"core", statistics.frames_per_second.core}};
  if (statistics.frames_per_second.system) rate["system"] = *statistics.frames_per_second.system;
  if (statistics.frames_per_second.steady) {
    rate["steady"] = statistics.frames_per_second.steady->frames_per_second;
    rate["steady_uncertainty"] = statistics.frames_per_second.steady->uncertainty;
  }
  Json& bound = document["bound"] = {{"core", statistics.bound.core},
                                     {"core_limited_by", statistics.bound.core_limited_by}};
  if (statistics.bound.system) {
    bound["system"] = *statistics.bound.system;
    bound["system_limited_by"] = statistics.bound.system_limited_by;
  }
  document["banks"] = rows(statistics.banks);
  document["ports"] = rows(statistics.ports);
  document["blame"] = rows(statistics.blame);
  if (statistics.computer) add_computer(*statistics.computer, document);
  document["area"] = area_json(statistics.area);
  if (!statistics.failed.empty()) document["failed"] = statistics.failed;
  if (accuracy) document["accuracy"] = to_json(*accuracy);
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
  if (reader.has("/failed")) reader.refuse("/failed", "must be a run in which nothing failed");
  platform::Statistics statistics;
  statistics.fidelity = fidelity;
  reader.read_list("/frame_cycles", statistics.frame_cycles,
                   [&](const std::string& path, std::uint64_t& cycles) { reader.read(path, cycles); });
  if (frames == 0 || statistics.frame_cycles.size() != frames)
    reader.refuse("/frame_cycles",
                  fmt::format("must have an entry for each of the {} frames of run.json", frames));
  reader.read("/bound/core", statistics.bound.core);
  reader.read("/bound/core_limited_by", statistics.bound.core_limited_by);
  reader.read_objects("/banks", statistics.banks);
  reader.read_objects("/ports", statistics.ports);
  reader.read_objects("/blame", statistics.blame);
  if (camera) read_computer(reader, statistics);
  statistics.banks.resize(board.banks.size());
  statistics.ports.resize(fpga::kPortCount);
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

}  // namespace stereotlm::report
