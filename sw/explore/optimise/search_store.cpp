#include "sw/explore/optimise/search_store.h"

#include <fmt/format.h>

#include <iterator>
#include <sstream>

#include "platform/config/board_yaml.h"
#include "sw/explore/store/store.h"
#include "sw/files/output_file.h"

namespace stereotlm::explore {
namespace {

constexpr int kApplicationId = 0x53544C4F;  // "STLO"
constexpr int kLayout = 1;

// Read back, the numbers are the same.
std::string numbers_text(const std::vector<double>& numbers) {
  return fmt::format("{}", fmt::join(numbers, " "));
}

// "0-4 7 9-10"
std::string ranges_text(const std::vector<std::uint32_t>& numbers) {
  std::string text;
  for (std::size_t first = 0, next = 0; first < numbers.size(); first = next) {
    for (next = first + 1; next < numbers.size() && numbers[next] == numbers[next - 1] + 1;) ++next;
    text += fmt::format("{}{}", text.empty() ? "" : " ", numbers[first]);
    if (next - first > 1) text += fmt::format("-{}", numbers[next - 1]);
  }
  return text;
}

// Inserts rows into one table.
class Rows {
 public:
  Rows(const sqlite::Database& database, const std::string& table, std::size_t columns)
      : insert_(database, fmt::format("INSERT INTO {} VALUES({})", table,
                                      fmt::join(std::vector<std::string>(columns, "?"), ", "))) {}

  using Value = std::variant<std::int64_t, double, std::string>;
  void add(const std::vector<std::optional<Value>>& values) {
    insert_.clear_bindings();
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (values[i]) insert_.bind(static_cast<int>(i) + 1, *values[i]);
    }
    insert_.run();
  }

 private:
  sqlite::Statement insert_;
};

Rows::Value value_of(std::uint64_t number) { return static_cast<std::int64_t>(number); }

}  // namespace

std::string verdict_text(Verdict verdict) {
  constexpr std::array kTexts = {"unknown", "impossible", "excluded", "unmet", "bound", "examined"};
  return kTexts[static_cast<std::size_t>(verdict)];
}

SearchStore::SearchStore(const std::string& path, const Asked& asked)
    : lock_(path), path_(behind_links(path)), asked_(asked) {
  // To write, because a process that was killed may have left a change that is to be rolled back.
  sqlite::Database database(path_, sqlite::Database::Access::kCreate);
  if (database.number("PRAGMA page_count") == 0) {
    database.execute("BEGIN IMMEDIATE");
    create(database);
    database.execute(
        "CREATE TABLE results(key TEXT PRIMARY KEY NOT NULL, value TEXT NOT NULL) WITHOUT ROWID; COMMIT");
    return;
  }
  if (database.number("PRAGMA application_id") != kApplicationId)
    throw sqlite::DatabaseError(path + ": not a database of stereotlm optimise");
  if (const auto layout = database.number("PRAGMA user_version"); layout != kLayout)
    throw sqlite::DatabaseError(fmt::format(
        "{}: its layout is {}, of another version; this version writes {}", path, layout, kLayout));
  is_finished_ = database.number("SELECT count(*) FROM sqlite_schema WHERE name = 'front'") > 0;
  const bool is_empty = !is_finished_ && database.number("SELECT count(*) FROM results") == 0;
  for (const auto& [name, value] : asked_) {
    sqlite::Statement row(database, "SELECT value FROM search WHERE name = ?");
    row.bind(1, name);
    if (row.step() && row.text(0) == value) continue;
    if (is_empty) {
      ask(database);
      return;
    }
    throw sqlite::DatabaseError(
        fmt::format("{}: holds another search, which differs in its {}: give another file", path,
                    name == "goals" ? "goals, requirements or placements" : name));
  }
}

void SearchStore::create(sqlite::Database& database) const {
  database.execute(
      fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {};"
                  "CREATE TABLE search(name TEXT PRIMARY KEY NOT NULL, value) WITHOUT ROWID",
                  kApplicationId, kLayout));
  ask(database);
}

void SearchStore::ask(sqlite::Database& database) const {
  database.execute("SAVEPOINT asked; DELETE FROM search");
  Rows rows(database, "search", 2);
  for (const auto& [name, value] : asked_) rows.add({name, value});
  database.execute("RELEASE asked");
}

SearchResults SearchStore::results() const {
  SearchResults results;
  if (is_finished_) return results;
  const sqlite::Database database(path_, sqlite::Database::Access::kRead);
  for (sqlite::Statement row(database, "SELECT key, value FROM results"); row.step();) {
    std::istringstream numbers(row.text(1));
    results.emplace(row.text(0), std::vector<double>(std::istream_iterator<double>(numbers), {}));
  }
  return results;
}

void SearchStore::add(const SearchResults& results) const {
  if (results.empty()) return;
  lock_.check();
  sqlite::Database database(path_, sqlite::Database::Access::kWrite);
  database.execute("BEGIN IMMEDIATE");
  sqlite::Statement insert(database, "INSERT OR IGNORE INTO results VALUES(?, ?)");
  for (const auto& [key, values] : results) {
    insert.bind(1, key);
    insert.bind(2, numbers_text(values));
    insert.run();
  }
  database.execute("COMMIT");
}

void SearchStore::finish(Search& search) const {
  lock_.check();
  using namespace std::string_literals;
  const auto kind =
      files::marked_kind("database of stereotlm optimise", {{0, "SQLite format 3\0"s}, {68, "STLO"}});
  files::OutputFile file(path_, kind);
  {
    sqlite::Database database(file.unfinished().string(), sqlite::Database::Access::kCreate,
                              sqlite::Database::kBusyTimeout, path_);
    database.execute("PRAGMA journal_mode = OFF; PRAGMA synchronous = NORMAL; BEGIN");
    create(database);
    database.execute(
        "CREATE TABLE goals(goal INTEGER PRIMARY KEY, figure TEXT NOT NULL, aim TEXT NOT NULL);"
        "CREATE TABLE requirements(condition TEXT NOT NULL);"
        "CREATE TABLE front(point INTEGER PRIMARY KEY, boards INTEGER NOT NULL, config TEXT NOT NULL);"
        "CREATE TABLE front_values(point INTEGER NOT NULL, goal INTEGER NOT NULL, least REAL NOT NULL,"
        "  most REAL NOT NULL, PRIMARY KEY(point, goal)) WITHOUT ROWID;"
        "CREATE TABLE front_boards(point INTEGER NOT NULL, combination INTEGER NOT NULL,"
        "  placement INTEGER NOT NULL, sets TEXT NOT NULL,"
        "  PRIMARY KEY(point, combination, placement)) WITHOUT ROWID;"
        "CREATE TABLE parts(first INTEGER PRIMARY KEY, last INTEGER NOT NULL, verdict TEXT NOT NULL,"
        "  reason TEXT NOT NULL);"
        "CREATE TABLE spaces(space INTEGER NOT NULL, number INTEGER NOT NULL, placements TEXT NOT NULL,"
        "  PRIMARY KEY(space, number)) WITHOUT ROWID;"
        "CREATE TABLE examined(combination INTEGER NOT NULL, space INTEGER NOT NULL, of TEXT NOT NULL,"
        "  numbers TEXT NOT NULL, fate TEXT NOT NULL, least_cycles INTEGER, results TEXT NOT NULL)");
    Rows of_search(database, "search", 2);
    of_search.add({"combinations", value_of(search.combinations())});
    of_search.add({"boards", value_of(search.state().boards)});
    Rows goals(database, "goals", 3);
    for (std::size_t i = 0; i < search.wishes().goals.size(); ++i) {
      const SearchWishes::Goal& goal = search.wishes().goals[i];
      goals.add({value_of(i), goal.figure.text, goal.is_maximum ? "maximise"s : "minimise"s});
    }
    Rows requirements(database, "requirements", 1);
    for (const Condition& one : search.wishes().requirements) requirements.add({one.text});
    Rows front(database, "front", 3);
    Rows values(database, "front_values", 4);
    Rows boards(database, "front_boards", 4);
    for (std::size_t i = 0; i < search.front().size(); ++i) {
      const FrontPoint& point = search.front()[i];
      const platform::BoardConfig first = *search.board(point.first.front()).board;
      front.add({value_of(i), value_of(point.boards), platform::to_yaml(first)});
      for (std::size_t goal = 0; goal < point.values.size(); ++goal)
        values.add({value_of(i), value_of(goal), point.values[goal].least, point.values[goal].most});
      for (const BoardNumber& number : point.first)
        boards.add(
            {value_of(i), value_of(number.combination), value_of(number.placement),
             fmt::format("{}", fmt::join(platform::sets_between(first, *search.board(number).board), "\n"))});
    }
    Rows parts(database, "parts", 4);
    Rows groups(database, "spaces", 3);
    Rows examined(database, "examined", 7);
    std::map<std::string, std::uint64_t> spaces;  // their numbers
    search.certify(
        {[&](const Search::Part& part) {
           parts.add({value_of(part.first), value_of(part.last), verdict_text(part.verdict), part.reason});
         },
         [&](const std::string& space, const Placements& placements) {
           const std::uint64_t number = spaces.emplace(space, spaces.size()).first->second;
           for (std::size_t group = 0; group < placements.groups().size(); ++group)
             groups.add(
                 {value_of(number), value_of(group), ranges_text(placements.groups()[group].placements)});
         },
         [&](const Search::Examined& one) {
           const auto space = spaces.emplace(one.space, spaces.size()).first->second;
           examined.add(
               {value_of(one.combination), value_of(space), one.are_groups ? "groups"s : "placements"s,
                ranges_text(one.numbers), one.fate,
                one.least_cycles ? std::optional(Rows::Value(value_of(*one.least_cycles))) : std::nullopt,
                numbers_text(one.results)});
         }});
    database.execute("COMMIT");
  }
  file.complete();
  file.commit();
}

std::vector<FrontPoint> SearchStore::front(std::size_t goals) const {
  const sqlite::Database database(path_, sqlite::Database::Access::kRead);
  std::vector<FrontPoint> front;
  for (sqlite::Statement row(database, "SELECT boards FROM front ORDER BY point"); row.step();)
    front.push_back({std::vector<Range>(goals), static_cast<std::uint64_t>(row.integer(0)), {}});
  for (sqlite::Statement row(database, "SELECT point, goal, least, most FROM front_values"); row.step();)
    front.at(static_cast<std::size_t>(row.integer(0))).values.at(static_cast<std::size_t>(row.integer(1))) = {
        row.real(2), row.real(3)};
  for (sqlite::Statement row(database, "SELECT point, combination, placement FROM front_boards"); row.step();)
    front.at(static_cast<std::size_t>(row.integer(0)))
        .first.push_back(
            {static_cast<std::uint64_t>(row.integer(1)), static_cast<std::uint32_t>(row.integer(2))});
  return front;
}

std::uint64_t SearchStore::boards() const {
  sqlite::Database database(path_, sqlite::Database::Access::kRead);
  return static_cast<std::uint64_t>(database.number("SELECT value FROM search WHERE name = 'boards'"));
}

Search::Impossible SearchStore::impossible() const {
  sqlite::Database database(path_, sqlite::Database::Access::kRead);
  const auto number = [&database](const char* what) {
    return static_cast<std::uint64_t>(
        database.number(fmt::format("SELECT coalesce({}, 0) FROM parts WHERE verdict = 'impossible'", what)));
  };
  return {number("sum(last - first + 1)"), number("min(first)")};
}

}  // namespace stereotlm::explore
