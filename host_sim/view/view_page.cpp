#include "host_sim/view/view_page.h"

#include <cstddef>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host_sim/files/output_file.h"
#include "host_sim/report/csv_table.h"
#include "host_sim/report/plots/html_page.h"
#include "host_sim/report/plots/png.h"
#include "host_sim/report/run_folder.h"
#include "host_sim/report/run_tables.h"
#include "host_sim/report/sections/html_report.h"
#include "host_sim/report/summary_json.h"
#include "host_sim/view/embedded_table.h"

// The bytes of the page, between the labels of page_template.S.
extern "C" const char vbar_view_page_begin[];
extern "C" const char vbar_view_page_end[];

namespace vbar::view {

namespace {

using nlohmann::json;

/// The cells of a table of the record, as its file has them.
CellTable cells_of(const report::RunRecord& record, const report::DescribedTable& described) {
  CellTable table{described.file, {}};
  for (const report::TableColumn& column : described.columns)
    table.columns.push_back({column.name, column.meaning, {}});
  const std::string text = report::table_text(record, described.file);
  std::vector<std::string> cells;
  for (std::size_t start = text.find('\n') + 1; start < text.size();) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    if (report::split_cells(std::string_view(text).substr(start, end - start), cells))
      for (std::size_t k = 0; k < table.columns.size() && k < cells.size(); ++k)
        table.columns[k].cells.push_back(std::move(cells[k]));
    start = end + 1;
  }
  return table;
}

json pictures_of(const report::RunRecord& record) {
  constexpr std::size_t kMaxPictures = 60;
  json pictures = json::array();
  for (const report::GalleryImage& image : record.gallery) {
    if (pictures.size() == kMaxPictures) break;
    pictures.push_back({{"time_s", image.time_s},
                        {"image", image.image},
                        {"caption", image.caption},
                        {"origin_px", {image.origin_x_px, image.origin_y_px}},
                        {"size_px", {image.width_px, image.height_px}},
                        {"target_radius_px", image.target_radius_px},
                        {"crop_px", {image.crop_left, image.crop_side}},
                        {"png", report::png_data_uri(image.png)}});
  }
  return pictures;
}

json json_of(const ViewedRun& run, const std::filesystem::path& data_directory) {
  const report::RunRecord& record = run.record;
  std::set<std::string> picture_times;
  for (const report::GalleryImage& image : record.gallery) picture_times.insert(fmt::format("{}", image.time_s));
  std::vector<CellTable> tables;
  for (const report::DescribedTable& described : report::described_tables(record.extensions))
    if (CellTable table = cells_of(record, described); table.rows() > 0) tables.push_back(std::move(table));
  json scene;
  std::string note = run.note;
  if (run.mission != nullptr) {
    try {
      scene = scene_of(*run.mission, record, data_directory);
      tables.push_back(sunlight_of(*run.mission, record));
    } catch (const std::exception& error) {
      note = error.what();
    }
  }
  return {{"name", run.name},
          {"summary", json::parse(report::summary_json(record.summary, record.waypoints))},
          {"tables", embedded(tables, kMaxTableBytes, picture_times)},
          {"pictures", pictures_of(record)},
          {"scene", std::move(scene)},
          {"note", std::move(note)}};
}

/// JSON inside a script element: nothing in it can end the element, or begin a comment.
std::string script_text(const json& value) {
  std::string text;
  for (const char c : value.dump(-1, ' ', true, json::error_handler_t::replace)) {
    if (c == '<')
      text += "\\u003c";
    else
      text += c;
  }
  return text;
}

/// Puts the text in place of the mark: its last one, as the title comes first and may be of any text.
void put(std::string& page, std::string_view mark, std::string_view text) {
  const std::size_t place = page.rfind(mark);
  if (place == std::string::npos) throw std::logic_error(fmt::format("the page has no place {}", mark));
  page.replace(place, mark.size(), text);
}

/// Takes the data of the tables out of the runs and returns elements of them, data-RUN-TABLE: a browser keeps several
/// copies of an element while it reads it, and gives the memory of each table back when it has read it.
std::string table_elements(json& runs) {
  std::string text;
  for (std::size_t run = 0; run < runs.size(); ++run) {
    json& tables = runs[run]["tables"];
    for (std::size_t k = 0; k < tables.size(); ++k) {
      text += fmt::format("<script type=\"text/plain\" id=\"data-{}-{}\">{}</script>\n", run, k,
                          tables[k]["data"].get_ref<const std::string&>());
      tables[k].erase("data");
    }
  }
  return text;
}

}  // namespace

std::string_view page_template() {
  return {vbar_view_page_begin, static_cast<std::size_t>(vbar_view_page_end - vbar_view_page_begin)};
}

std::string filled_page(std::string_view title, json runs) {
  if (page_template().empty()) throw std::runtime_error(kHowToGetPage);
  std::string page(page_template());
  put(page, "@TITLE@", report::escaped(title));
  put(page, "@TABLES@", table_elements(runs));
  put(page, "@RUNS@", script_text(runs));
  return page;
}

std::string view_page(std::span<const ViewedRun> runs, const std::filesystem::path& data_directory) {
  std::string names;
  json data = json::array();
  for (const ViewedRun& run : runs) {
    names += (names.empty() ? "" : " | ") + run.name;
    data.push_back(json_of(run, data_directory));
  }
  return filled_page(names, std::move(data));
}

void write_view(const std::filesystem::path& file, std::span<const ViewedRun> runs,
                const std::filesystem::path& data_directory) {
  files::replace_text_file(file, view_page(runs, data_directory));
}

std::filesystem::path write_pages(const std::filesystem::path& run_folder, const ViewedRun& run,
                                  const std::filesystem::path& data_directory) {
  if (page_template().empty())
    return report::write_html_report(run_folder, run.record, fmt::format("No view.html: {}.", kHowToGetPage));
  const std::filesystem::path file = report::view_file(run_folder);
  write_view(file, std::span(&run, 1), data_directory);
  return report::write_html_report(
      run_folder, run.record,
      fmt::format("<a href=\"{}\">Watch the flight</a>: scene, plots and all tables over time.",
                  file.filename().string()));
}

}  // namespace vbar::view
