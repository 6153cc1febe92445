#include "host_sim/report/plots/html_page.h"

#include <algorithm>

#include <fmt/format.h>

#include "host_sim/report/plots/html_style.h"

namespace vbar::report {
namespace {

std::string cell(std::string_view tag, const Column& column, std::string_view text) {
  const bool is_html = column.is_html && tag != "th";
  return fmt::format("<{0}{1}>{2}</{0}>", tag, column.is_number ? " class=\"number\"" : "",
                     is_html ? std::string(text) : escaped(text));
}

/// "Angles-only navigation" is found at "angles-only-navigation".
std::string anchor(std::string_view heading) {
  std::string out;
  for (const char c : heading) {
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
    out += is_plain ? c : c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : '-';
  }
  return out;
}

/// Returns the part that a page break must not separate from the heading: all up to the end of the first row of
/// figures, unless a table comes before it; then nothing.
std::size_t size_kept_with_heading(std::string_view content) {
  constexpr std::string_view kRowEnd = "</div>\n";
  const std::size_t row = content.find("<div class=\"figures");
  const std::size_t table = std::min(content.find("<table"), content.find("<dl"));
  if (row == std::string_view::npos || table < row) return 0;
  return content.find(kRowEnd, row) + kRowEnd.size();
}

}  // namespace

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '&':
        out += "&amp;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string html_page(std::string_view title, std::string_view body) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n"
      "<meta name=\"color-scheme\" content=\"light dark\"/>\n<title>{}</title>\n<style>{}</style>\n</head>\n"
      "<body>\n<main>\n{}</main>\n</body>\n</html>\n",
      escaped(title), kStyleSheet, body);
}

std::string section_html(const Section& section) {
  if (section.content.empty()) return {};
  std::string head = fmt::format("<h2>{}</h2>\n", escaped(section.heading));
  if (!section.files.empty()) {
    head += "<p class=\"files\">Data:";
    for (const std::string& file : section.files) head += fmt::format(" <a href=\"{0}\">{0}</a>", escaped(file));
    head += "</p>\n";
  }
  const std::size_t kept = size_kept_with_heading(section.content);
  return fmt::format("<section id=\"{}\">\n<div class=\"keep\">\n{}{}</div>\n{}</section>\n", anchor(section.heading),
                     head, section.content.substr(0, kept), section.content.substr(kept));
}

std::string contents(const std::vector<Section>& sections) {
  std::string out = "<nav>";
  for (const Section& section : sections) {
    if (section.content.empty()) continue;
    out += fmt::format("<a href=\"#{}\">{}</a> ", anchor(section.heading), escaped(section.heading));
  }
  return out + "</nav>\n";
}

std::string figures(int columns, const std::vector<std::string>& figures) {
  std::string out;
  const auto a_row = static_cast<std::size_t>(columns);
  for (std::size_t k = 0; k < figures.size(); ++k) {
    if (k % a_row == 0) out += fmt::format("<div class=\"figures of{}\">\n", columns);
    out += fmt::format("<figure>{}</figure>\n", figures[k]);
    if ((k + 1) % a_row == 0 || k + 1 == figures.size()) out += "</div>\n";
  }
  return out;
}

std::string table(const std::vector<Column>& columns, const std::vector<std::vector<std::string>>& rows) {
  std::string out = "<div class=\"scroll\"><table>\n<thead><tr>";
  for (const Column& column : columns) out += cell("th", column, column.head);
  out += "</tr></thead>\n<tbody>\n";
  for (const std::vector<std::string>& row : rows) {
    if (row.size() == 1) {
      out += fmt::format("<tr><th class=\"group\" colspan=\"{}\">{}</th></tr>\n", columns.size(), escaped(row.front()));
      continue;
    }
    out += "<tr>";
    for (std::size_t k = 0; k < columns.size(); ++k) out += cell("td", columns[k], row.at(k));
    out += "</tr>\n";
  }
  return out + "</tbody>\n</table></div>\n";
}

std::string fact_list(const std::vector<Fact>& facts) {
  std::string out = "<dl>\n";
  for (const Fact& fact : facts) {
    out += fmt::format("<div><dt>{}</dt><dd{}>{}</dd></div>\n", escaped(fact.name), fact.is_bad ? " class=\"bad\"" : "",
                       escaped(fact.value));
  }
  return out + "</dl>\n";
}

}  // namespace vbar::report
