#include "host_sim/truth/atmosphere/nrlmsise00_tables.h"

#include <charconv>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "host_sim/files/data_stream.h"
#include "host_sim/files/text_lines.h"

namespace vbar::truth {
namespace {

class TableReader {
 public:
  explicit TableReader(const std::filesystem::path& file) : file_(file), in_(file) {
    if (!in_) throw std::runtime_error(fmt::format("{}: cannot open the atmosphere's coefficients", file.string()));
  }

  template <std::size_t kColumns>
  void read(std::string_view name, std::array<double, kColumns>& array) {
    expect_line(fmt::format("array,{},1,{}", name, kColumns));
    read_row(name, array);
  }

  template <std::size_t kRows, std::size_t kColumns>
  void read(std::string_view name, std::array<std::array<double, kColumns>, kRows>& array) {
    expect_line(fmt::format("array,{},{},{}", name, kRows, kColumns));
    for (auto& row : array) read_row(name, row);
  }

  void expect_line(const std::string& expected) {
    next(expected);
    if (line_ != expected) fail(excerpt(), expected);
  }

 private:
  void next(const std::string& expected) {
    do {
      ++number_;
      if (!std::getline(in_, line_)) fail("the file ends here", expected);
    } while (line_.starts_with('#'));
  }

  template <std::size_t kColumns>
  void read_row(std::string_view name, std::array<double, kColumns>& row) {
    const std::string expected = fmt::format("{} numbers of array {}", kColumns, name);
    next(expected);
    const char* at = line_.data();
    const char* const end = at + line_.size();
    for (std::size_t column = 0; column < kColumns; ++column) {
      const auto [after, error] = std::from_chars(at, end, row[column]);
      if (error != std::errc{} || !std::isfinite(row[column])) fail(excerpt(), expected);
      at = after;
      const bool last = column + 1 == kColumns;
      if (last ? at != end : (at == end || *at++ != ',')) fail(excerpt(), expected);
    }
  }

  std::string excerpt() const { return "found " + files::quoted(line_); }

  [[noreturn]] void fail(std::string_view found, std::string_view expected) const {
    throw std::runtime_error(fmt::format("{}:{}: {}, expected {}", file_.string(), number_, found, expected));
  }

  std::filesystem::path file_;
  files::DataStream in_;
  std::string line_;
  int number_ = 0;
};

}  // namespace

Nrlmsise00Tables load_nrlmsise00_tables(const std::filesystem::path& file) {
  TableReader reader(file);
  Nrlmsise00Tables tables;
  reader.read("pt", tables.pt);
  reader.read("pd", tables.pd);
  reader.read("ps", tables.ps);
  reader.read("pdl", tables.pdl);
  reader.read("ptm", tables.ptm);
  reader.read("pdm", tables.pdm);
  reader.read("ptl", tables.ptl);
  reader.read("pma", tables.pma);
  reader.read("pavgm", tables.pavgm);
  reader.expect_line("end");
  return tables;
}

}  // namespace vbar::truth
