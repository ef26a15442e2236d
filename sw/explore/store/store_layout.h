#pragma once

#include <array>
#include <string>
#include <vector>

#include "sw/explore/store/database.h"

namespace stereotlm::explore {

// The tables of a store, for whoever reads or writes one: see Store. All throw DatabaseError.

// The columns of `points` that every store has, in front.
inline constexpr std::array kFirstColumns = {"hash", "status", "reason", "version", "config"};
inline constexpr const char* kBlameColumns = "hash, port, bank, by, cycles";

// In an empty database.
void create_tables(Database& database, const std::vector<std::string>& further_columns);
// Throws if the file is no store, or one of another layout.
void check_layout(Database& database);

// The first column of what a query gives.
std::vector<std::string> names_of(const Database& database, const std::string& sql);
// Of `points`, in their order.
std::vector<std::string> columns_of(const Database& database);

void insert_key(const Database& database, const std::string& name);
// To insert a point with these columns, unless it is there; a row of blame.
std::string insert_point_sql(const std::vector<std::string>& columns);
std::string insert_blame_sql();

}  // namespace stereotlm::explore
