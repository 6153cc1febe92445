#include "host_sim/report/html_page.h"

#include <fmt/format.h>

#include "host_sim/report/html_style.h"

namespace vbar::report {
namespace {

std::string cell(std::string_view tag, const Column& column, std::string_view text) {
  return fmt::format("<{0}{1}>{2}</{0}>", tag, column.is_number ? " class=\"number\"" : "", escaped(text));
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

std::string section(std::string_view heading, std::string_view content) {
  if (content.empty()) return {};
  return fmt::format("<section>\n<h2>{}</h2>\n{}</section>\n", escaped(heading), content);
}

std::string figures(int columns, const std::vector<std::string>& figures) {
  std::string out = fmt::format("<div class=\"figures of{}\">\n", columns);
  for (const std::string& figure : figures) out += fmt::format("<figure>{}</figure>\n", figure);
  return out + "</div>\n";
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
    out += fmt::format("<div><dt>{}</dt><dd>{}</dd></div>\n", escaped(fact.name), escaped(fact.value));
  }
  return out + "</dl>\n";
}

}  // namespace vbar::report
