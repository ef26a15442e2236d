#pragma once

#include <map>
#include <string>
#include <vector>

#include "sw/paper/study.h"

namespace stereotlm::paper {

// The report on the findings.
inline constexpr const char* kDocument = "paper.md";
// The pictures of the report, drawn from the tables.
inline constexpr const char* kFigures[] = {"table1", "table2", "banks"};

// The files beside the report: tables and pictures.
std::vector<std::string> file_names();

// The tables by name: table1.csv, table2.csv, banks.csv, claims.csv. Numbers are the shortest decimals that read
// back equal, as in stats.json.
std::map<std::string, std::string> tables(const Findings& findings);

// paper.md: each claim with its rule, its values and the commands that reproduce them.
std::string document(const Findings& findings);

// One line per claim, then one per case that is not confirmed; at most 100 columns.
std::string summary(const Findings& findings);

}  // namespace stereotlm::paper
