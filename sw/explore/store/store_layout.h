#pragma once

#include <array>
#include <string>
#include <vector>

#include "sw/files/output_file.h"
#include "sw/sqlite/database.h"

namespace stereotlm::explore {

// The tables of a store, for the classes that read or write stores (see Store). All functions throw
// DatabaseError.

// The first columns of `points`, which every store has.
inline constexpr std::array kFirstColumns = {"hash", "status", "reason", "version", "config"};
inline constexpr const char* kBlameColumns = "hash, port, bank, by, cycles";

// Creates the tables in an empty database. `schema`: the name under which it is attached.
void create_tables(sqlite::Database& database, const std::vector<std::string>& further_columns,
                   const std::string& schema = "main");
// Creates table `points` alone.
void create_points(sqlite::Database& database, const std::vector<std::string>& further_columns,
                   const std::string& schema = "main");
// How a file that is a store begins.
files::FileKind store_kind();
// Throws if the file is not a store, or has another layout.
void check_layout(sqlite::Database& database);
// Throws if the store holds points of another version of the program.
void check_version(sqlite::Database& database, const std::string& version);

// The first column of each row of a query.
std::vector<std::string> first_column_of(const sqlite::Database& database, const std::string& sql);
// The columns of `points`, in their order.
std::vector<std::string> columns_of(const sqlite::Database& database);

// Notes in table `keys` that this column of `points` is a key of the board, not a figure.
void insert_board_key(const sqlite::Database& database, const std::string& name);

}  // namespace stereotlm::explore
