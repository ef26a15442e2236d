#include "sw/explore/conditions.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <stdexcept>

#include "platform/board_keys.h"

namespace stereotlm::explore {
namespace {

using platform::BoardValue;

constexpr const char* kBankCount = "ssram.banks";

// What conditions may name, "table.column", in the order of the parameters.
const std::vector<std::string>& names() {
  static const std::vector<std::string> kNames = [] {
    std::vector<std::string> all;
    for (const platform::Key& key : platform::board_keys()) {
      if (key.path.find("ssram.") == 0 || key.path.find("matcher.filter.") == 0 || key.path == "pci.load")
        continue;
      all.push_back(key.path == "name" ? "board.name" : key.path);
    }
    all.insert(all.end(), {kBankCount, "run.source", "run.frames"});
    return all;
  }();
  return kNames;
}

// "SELECT (text) FROM (SELECT ?1 AS width, ..) AS image, .."
std::string query(const std::string& text) {
  std::vector<std::string> tables;
  std::map<std::string, std::string> columns;
  for (std::size_t i = 0; i < names().size(); ++i) {
    const std::string& name = names()[i];
    const std::size_t dot = name.find('.');
    const std::string table = name.substr(0, dot);
    std::string& list = columns[table];
    if (list.empty()) tables.push_back(table);
    list += fmt::format("{}?{} AS \"{}\"", list.empty() ? "" : ", ", i + 1, name.substr(dot + 1));
  }
  std::string from;
  for (const std::string& table : tables) {
    from += fmt::format("{}(SELECT {}) AS {}", from.empty() ? "" : ", ", columns[table], table);
  }
  return fmt::format("SELECT (({}\n)) FROM {}", text, from);
}

bool is_bank_words(const std::string& path) {
  const std::string begin = "ssram.banks.";
  const std::string end = ".words";
  return path.size() > begin.size() + end.size() && path.compare(0, begin.size(), begin) == 0 &&
         path.compare(path.size() - end.size(), end.size(), end) == 0;
}

}  // namespace

Conditions::Conditions(const std::vector<std::string>& texts)
    : database_("where", Database::Access::kMemory) {
  for (const std::string& text : texts) {
    try {
      statements_.push_back(std::make_unique<Statement>(database_, query(text)));
    } catch (const DatabaseError& error) {
      const std::string place = database_.path() + ": ";
      throw std::invalid_argument(std::string(error.what()).substr(place.size()));
    }
  }
}

bool Conditions::hold(const std::vector<BoardValue>& values) {
  if (statements_.empty()) return true;
  std::vector<const BoardValue*> given(names().size());
  const auto place_of = [](const std::string& name) {
    return static_cast<std::size_t>(std::find(names().begin(), names().end(), name) - names().begin());
  };
  BoardValue banks{kBankCount, std::int64_t{0}};
  for (const BoardValue& value : values) {
    if (is_bank_words(value.path)) ++std::get<std::int64_t>(banks.value);
    const std::size_t place = place_of(value.path == "name" ? "board.name" : value.path);
    if (place < given.size()) given[place] = &value;
  }
  given[place_of(kBankCount)] = &banks;
  for (const auto& statement : statements_) {
    statement->clear_bindings();
    for (std::size_t i = 0; i < given.size(); ++i) {
      if (given[i] != nullptr) statement->bind(static_cast<int>(i) + 1, *given[i]);
    }
    const bool is_true = statement->step() && statement->is_true(0);
    statement->reset();
    if (!is_true) return false;
  }
  return true;
}

}  // namespace stereotlm::explore
