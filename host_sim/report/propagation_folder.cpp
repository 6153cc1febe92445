#include "host_sim/report/propagation_folder.h"

#include <stdexcept>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host_sim/report/propagation_summary.h"
#include "host_sim/report/text_file.h"

namespace vbar::report {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSummary = "propagation.json";

[[noreturn]] void fail(const fs::path& folder, std::string_view what) {
  throw std::runtime_error(fmt::format("{}: {}", folder.string(), what));
}

/// The files of the propagation that `folder` holds.
std::vector<std::string> files_left(const fs::path& folder) {
  if (!fs::is_regular_file(folder / kSummary))
    fail(folder, "holds something other than a propagation; remove it or name another folder with --out");
  const auto json = nlohmann::json::parse(files::read_text_file(folder / kSummary), nullptr, false);
  if (!json.is_object() || !json.contains("files")) fail(folder / kSummary, "is not that of a propagation");
  return json.at("files").get<std::vector<std::string>>();
}

void clear(const fs::path& folder) {
  if (!fs::exists(folder)) return;
  if (!fs::is_directory(folder)) fail(folder, "is a file; a propagation needs a folder");
  if (fs::is_empty(folder)) return;
  for (const std::string& name : files_left(folder)) {
    if (fs::path(name).filename() != name) fail(folder / kSummary, "lists a file outside its folder");
    fs::remove(folder / name);
    fs::remove(files::PartialFile::part_of(folder / name));
  }
}

}  // namespace

fs::path default_propagation_folder(const std::string& mission) {
  return fs::path("runs") / (mission + "-truth");
}

PropagationFolder::PropagationFolder(fs::path folder, const std::string& mission) : folder_(std::move(folder)) {
  try {
    clear(folder_);
    fs::create_directories(folder_);
  } catch (const fs::filesystem_error& error) {
    fail(folder_, "cannot be made: " + error.code().message());
  }
  PropagationRecord running;
  running.mission = mission;
  running.incomplete_reason = "running";
  files::replace_text_file(folder_ / kSummary, propagation_json(running, file_names_));
}

void PropagationFolder::start_files(std::span<const std::string> names, const OemFile::Span* oem) {
  for (const std::string& name : names) {
    file_names_.push_back(name + ".csv");
    csv_.emplace_back(folder_ / file_names_.back());
    if (oem == nullptr) continue;
    file_names_.push_back(name + ".oem");
    oem_.emplace_back(folder_ / file_names_.back(), name, *oem);
  }
}

void PropagationFolder::append(std::size_t spacecraft, const EphemerisRow& row) {
  csv_.at(spacecraft).append(row);
  if (!oem_.empty()) oem_.at(spacecraft).append(row);
}

void PropagationFolder::finish(const PropagationRecord& record) {
  if (record.complete) {
    for (EphemerisCsv& file : csv_) file.finish();
    for (OemFile& file : oem_) file.finish();
  }
  csv_.clear();  // parts are closed, and so whole up to where they end
  oem_.clear();
  files::replace_text_file(folder_ / kSummary, propagation_json(record, file_names_));
}

}  // namespace vbar::report
