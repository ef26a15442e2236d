#pragma once

#include <map>
#include <string>

#include "sw/paper/study.h"

namespace stereotlm::paper {

// File name of the report on the findings.
inline constexpr const char* kDocument = "paper.md";
// The contents of the tables by file name: table1.csv, table2.csv, banks.csv, costs.csv, claims.csv. Numbers
// are the shortest decimals that read back equal, as in stats.json.
std::map<std::string, std::string> tables(const Findings& findings);

// How paper.md begins. No other document begins so.
inline constexpr const char* kDocumentMark =
    "# The paper's figures beside the model's\n\nWritten by `stereotlm paper`. ";

// paper.md: each claim with its rule, its values and the commands that reproduce them.
std::string document(const Findings& findings);

// The text that `paper` prints: how many claims have which verdict; a line for each claim, those that are not
// confirmed first; a sentence for each case that is not confirmed. At most 100 columns.
std::string summary(const Findings& findings);

}  // namespace stereotlm::paper
