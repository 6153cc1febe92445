#pragma once
// The page around a report: one file without any other, readable in light and dark and on paper.

#include <string>
#include <string_view>
#include <vector>

namespace vbar::report {

/// Text with <, >, & and quotes made harmless.
[[nodiscard]] std::string escaped(std::string_view text);

/// A whole HTML document; `body` is HTML.
[[nodiscard]] std::string html_page(std::string_view title, std::string_view body);

/// A heading, what stands under it as HTML, and the files of the run folder that it shows. Without content it is left
/// out of the page.
struct Section {
  std::string heading, content;
  std::vector<std::string> files{};
};
[[nodiscard]] std::string section_html(const Section& section);

/// Links to the sections that have content.
[[nodiscard]] std::string contents(const std::vector<Section>& sections);

/// Figures side by side, `columns` a row on a wide screen. A row is not split between printed pages.
[[nodiscard]] std::string figures(int columns, const std::vector<std::string>& figures);

struct Column {
  std::string head;
  bool is_number = true;  ///< numbers are set flush right
  bool is_html = false;   ///< its cells are HTML, not text
};

/// Cells are text, unless their column says otherwise. A row of a single cell is a heading across all columns.
[[nodiscard]] std::string table(const std::vector<Column>& columns, const std::vector<std::vector<std::string>>& rows);

/// Names and values, one a line; values are text.
struct Fact {
  std::string name, value;
  bool is_bad = false;  ///< set off from the others: a value out of its limits
};
[[nodiscard]] std::string fact_list(const std::vector<Fact>& facts);

}  // namespace vbar::report
