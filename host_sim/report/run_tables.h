#pragma once
// Rows of a run as CSV files: a head of column names, then a line a row. Row is one of run_record.h.

#include <filesystem>
#include <vector>

#include "host_sim/report/run_record.h"

namespace vbar::report {

/// Throws std::runtime_error that names the file.
template <class Row>
void write_rows(const std::filesystem::path& file, const std::vector<Row>& rows);

/// Throws std::runtime_error that names the file and, where there is one, the line and the column.
template <class Row>
[[nodiscard]] std::vector<Row> read_rows(const std::filesystem::path& file);

}  // namespace vbar::report
