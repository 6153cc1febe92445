#pragma once
// The tables of a run folder: a head of column names, then a line a row. One list (run_tables.cpp) says which there
// are; the messages of telemetry that have none of their own add themselves.

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "host_sim/files/output_file.h"
#include "host_sim/report/run_record.h"

namespace vbar::report {

struct TableKind;

/// A column of a table, and what it means.
struct TableColumn {
  std::string name, meaning;
  std::string stem;  ///< the same of all elements of an array
};

/// The names of all files that tables are written to.
[[nodiscard]] std::vector<std::string> table_files(Extensions extensions = {});

/// A table and its columns, in the order of the file.
struct DescribedTable {
  std::string file;
  std::vector<TableColumn> columns;
};
[[nodiscard]] std::vector<DescribedTable> described_tables(Extensions extensions = {});

/// A table's text: head and rows of the file `name` of table_files().
[[nodiscard]] std::string table_text(const RunRecord& record, const std::string& name);

/// Writes tables while the run goes on. Until finish() they are files `<name>.part`: what a killed run leaves.
class TableWriter {
 public:
  explicit TableWriter(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Appends the rows that came since the last call; short tables whose rows still change are rewritten. Throws
  /// std::runtime_error that names the file.
  void update(const RunRecord& record);

  /// Writes the rest and gives the files their names.
  void finish(const RunRecord& record);

 private:
  struct Growing {
    files::PartialFile file;
    std::size_t rows = 0;
  };
  void append(const TableKind& table, const RunRecord& record);

  std::filesystem::path folder_;
  std::map<std::string, Growing> growing_;
};

/// Reads all tables of a folder into the record. Columns are found by their names: one that is missing leaves the
/// default, one that is unknown is ignored with a line in record.notes, one of an older version is converted. Throws
/// std::runtime_error that names the file and, where there is one, the line and the column.
void read_tables(const std::filesystem::path& folder, RunRecord& record);

}  // namespace vbar::report
