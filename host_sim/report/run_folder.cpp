#include "host_sim/report/run_folder.h"

#include <algorithm>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "host_sim/report/run_tables.h"
#include "host_sim/report/summary_json.h"
#include "host_sim/report/text_file.h"

namespace vbar::report {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kSummary = "summary.json";
constexpr std::string_view kPictures = "gallery";  // a folder
constexpr std::string_view kPacketLog = "packets.lcmlog";
constexpr std::string_view kReport = "report.html";

[[noreturn]] void fail(const fs::path& folder, std::string_view what) {
  throw std::runtime_error(fmt::format("{}: {}", folder.string(), what));
}

[[noreturn]] void refuse(const fs::path& folder, std::string_view what) {
  throw FolderRefused(fmt::format("{}: {}", folder.string(), what));
}

void check_may_be_used(const fs::path& folder, RunFolder::Existing existing) {
  if (!fs::exists(folder)) return;
  if (!fs::is_directory(folder)) refuse(folder, "is a file; a run needs a folder");
  const bool holds_run = is_summary(folder / kSummary);
  if (holds_run && existing == RunFolder::Existing::kRefuse)
    refuse(folder, "holds a run; name another folder with --out, or replace that run with --force");
  const auto is_lock = [](const fs::directory_entry& entry) { return entry.path().filename() == RunLock::kFile; };
  if (holds_run || std::ranges::all_of(fs::directory_iterator(folder), is_lock)) return;
  refuse(folder, "holds something other than a run; remove it or name another folder with --out");
}

/// `kind`: "" of the image itself, "_twin", "_difference".
fs::path picture_file(const fs::path& folder, const GalleryImage& image, std::string_view kind = "") {
  return folder / kPictures / fmt::format("{:05}{}.png", image.image, kind);
}

void write_picture(const fs::path& file, const std::vector<std::uint8_t>& png) {
  replace_text_file(file, std::string(png.begin(), png.end()));
}

std::vector<std::uint8_t> read_picture(const fs::path& file) {
  const std::string bytes = read_text_file(file);
  return {bytes.begin(), bytes.end()};
}

void write_pictures(const fs::path& folder, const std::vector<GalleryImage>& gallery) {
  if (!gallery.empty()) fs::create_directories(folder / kPictures);
  for (const GalleryImage& image : gallery) {
    write_picture(picture_file(folder, image), image.png);
    if (image.difference.empty()) continue;
    write_picture(picture_file(folder, image, "_twin"), image.twin_png);
    write_picture(picture_file(folder, image, "_difference"), image.difference_png);
  }
}

void read_pictures(const fs::path& folder, std::vector<GalleryImage>& gallery) {
  for (GalleryImage& image : gallery) {
    image.png = read_picture(picture_file(folder, image));
    if (image.difference.empty()) continue;
    image.twin_png = read_picture(picture_file(folder, image, "_twin"));
    image.difference_png = read_picture(picture_file(folder, image, "_difference"));
  }
}

}  // namespace

fs::path default_run_folder(const std::string& mission, std::uint64_t seed) {
  const fs::path first = fs::path("runs") / fmt::format("{}-{}", mission, seed);
  fs::path folder = first;
  for (int number = 2; fs::exists(folder); ++number) folder = fmt::format("{}.{}", first.string(), number);
  return folder;
}

fs::path summary_file(const fs::path& run_folder) {
  return run_folder / kSummary;
}
fs::path packet_log_file(const fs::path& run_folder) {
  return run_folder / kPacketLog;
}
fs::path report_file(const fs::path& run_folder) {
  return run_folder / kReport;
}

std::vector<std::string> flight_files(Extensions extensions) {
  std::vector<std::string> names{std::string(kPacketLog), std::string(kPictures)};
  std::vector<std::string> whole = table_files(extensions);
  whole.emplace_back(kReport);
  for (const std::string& name : whole)
    names.insert(names.end(), {name, PartialFile::part_of(name).string(), neighbour_of(name).string()});
  return names;
}

RunFolder::RunFolder(fs::path folder, const Summary& start, Existing existing, Extensions extensions)
    : folder_(std::move(folder)), tables_(folder_) {
  try {
    check_may_be_used(folder_, existing);
    fs::create_directories(folder_);
    lock_.emplace(folder_);
    check_may_be_used(folder_, existing);  // another run may have come and gone before the lock was taken
    Summary running = start;
    running.complete = false;
    running.incomplete_reason = fmt::format("running in process {}, or killed", ::getpid());
    replace_text_file(folder_ / kSummary, summary_json(running, {}));
    for (const std::string& name : flight_files(extensions)) fs::remove_all(folder_ / name);
  } catch (const fs::filesystem_error& error) {
    fail(folder_, "cannot be made: " + error.code().message());
  }
}

void RunFolder::update(const RunRecord& record) {
  if (with_tables_) tables_.update(record);
}

void RunFolder::finish(const RunRecord& record) {
  if (with_tables_) {
    write_pictures(folder_, record.gallery);
    tables_.finish(record);
  }
  replace_text_file(folder_ / kSummary, summary_json(record.summary, record.waypoints));
}

void RunFolder::give_up(Summary summary, const std::string& reason) const {
  summary.complete = false;
  summary.incomplete_reason = reason;
  const std::string text = summary_json(summary, {});
  try {
    replace_text_file(folder_ / kSummary, text);
  } catch (const std::runtime_error&) {
    // A full disk takes no second file, but its blocks of the first: overwritten in place, without the data that were
    // read, it fits.
    summary.provenance.data.clear();
    std::fstream file(folder_ / kSummary, std::ios::in | std::ios::out | std::ios::binary);
    const std::string short_text = summary_json(summary, {});
    file.write(short_text.data(), static_cast<std::streamsize>(short_text.size()));
    file.close();
    if (!file) return;
    std::error_code ignored;
    fs::resize_file(folder_ / kSummary, short_text.size(), ignored);
  }
}

RunRecord read_run(const fs::path& run_folder, Extensions extensions) {
  if (!fs::is_directory(run_folder)) fail(run_folder, "no such run folder");
  RunRecord record;
  record.extensions = extensions;
  record.summary = read_summary(run_folder / kSummary);
  const fs::path truth = run_folder / "truth.csv";
  if (!record.summary.complete && !fs::exists(truth) && !fs::exists(PartialFile::part_of(truth))) {
    fail(run_folder,
         fmt::format("the run did not end (it says \"{}\") and left no tables", record.summary.incomplete_reason));
  }
  read_tables(run_folder, record);
  if (!fs::exists(run_folder / kPictures) && !record.summary.complete) record.gallery.clear();  // written at the end
  read_pictures(run_folder, record.gallery);
  return record;
}

}  // namespace vbar::report
