#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "sw/explore/store/store.h"
#include "tests/support/scratch_folder.h"

namespace stereotlm::explore {

inline StoredPoint ok_point(const std::string& hash) { return {hash, "ok", "", "", {}, {}}; }

// A test that has a folder for databases.
class StoreFiles : public ::testing::Test {
 protected:
  std::string file(const std::string& name) const { return (folder_.path() / name).string(); }

  // The names of the files in a folder.
  static std::vector<std::string> names_in(const std::filesystem::path& folder) {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
      names.push_back(entry.path().filename().string());
    return names;
  }
  std::vector<std::string> names() const { return names_in(folder_.path()); }

  // Adds points to a database, and makes it if there is none.
  void add(const std::string& name, const std::vector<StoredPoint>& points,
           const std::string& version = "1") const {
    Store store(file(name), version);
    for (const StoredPoint& point : points) store.add(point);
  }

  void merge(const std::vector<std::string>& inputs, const std::string& out) const {
    std::vector<std::string> paths;
    for (const std::string& input : inputs) paths.push_back(file(input));
    merge_stores(paths, file(out));
  }
  std::string merge_error(const std::vector<std::string>& inputs, const std::string& out) const {
    return test::message_of([&] { merge(inputs, out); });
  }

  // The rows of a query, the columns joined by "|".
  std::vector<std::string> rows(const std::string& name, const std::string& sql) const {
    sqlite::Database database(file(name), sqlite::Database::Access::kRead);
    sqlite::Statement statement(database, sql);
    std::vector<std::string> rows;
    while (statement.step()) {
      rows.push_back(statement.text(0));
      for (int column = 1; column < statement.columns(); ++column)
        rows.back() += '|' + statement.text(column);
    }
    return rows;
  }
  std::vector<std::string> hashes(const std::string& name) const {
    return rows(name, "SELECT hash FROM points ORDER BY hash");
  }

 private:
  test::ScratchFolder folder_;
};

}  // namespace stereotlm::explore
