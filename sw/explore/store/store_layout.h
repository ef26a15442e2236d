#pragma once

#include <array>
#include <string>
#include <vector>

#include "sw/explore/store/database.h"

namespace stereotlm::explore {

// The tables of a store, for the classes that read or write one (see Store). All functions throw
// DatabaseError.

// The first columns of `points`, which every store has.
inline constexpr std::array kFirstColumns = {"hash", "status", "reason", "version", "config"};
inline constexpr const char* kBlameColumns = "hash, port, bank, by, cycles";

// The query for has_point().
inline constexpr const char* kFindPoint = "SELECT 1 FROM points WHERE hash = ?";
bool has_point(Statement& find, const std::string& hash);

// Creates the tables in an empty database.
void create_tables(Database& database, const std::vector<std::string>& further_columns);
// Throws if the file is not a store, or has another layout.
void check_layout(Database& database);
// Throws if the store holds points of another version of the program.
void check_version(Database& database, const std::string& version);

// The first column of each row of a query.
std::vector<std::string> names_of(const Database& database, const std::string& sql);
// The columns of `points`, in their order.
std::vector<std::string> columns_of(const Database& database);

void insert_key(const Database& database, const std::string& name);
// SQL that inserts a point with these columns, unless it exists; and SQL that inserts a row of blame.
std::string insert_point_sql(const std::vector<std::string>& columns);
std::string insert_blame_sql();

}  // namespace stereotlm::explore
