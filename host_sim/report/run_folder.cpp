#include "host_sim/report/run_folder.h"

#include <algorithm>
#include <array>
#include <fstream>
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
constexpr std::string_view kWaypoints = "waypoints.csv";
constexpr std::string_view kTruth = "truth.csv";
constexpr std::string_view kAttitude = "attitude.csv";
constexpr std::string_view kEstimate = "estimate.csv";
constexpr std::string_view kGnss = "gnss.csv";
constexpr std::string_view kImages = "images.csv";
constexpr std::string_view kObjects = "objects.csv";
constexpr std::string_view kPoses = "poses.csv";
constexpr std::string_view kKeypoints = "keypoints.csv";
constexpr std::string_view kGallery = "gallery.csv";
constexpr std::string_view kPictures = "gallery";  // a folder
constexpr std::string_view kManeuvers = "maneuvers.csv";
constexpr std::string_view kResiduals = "residuals.csv";
constexpr std::string_view kPacketLog = "packets.lcmlog";
constexpr std::string_view kReport = "report.html";

constexpr std::array kFilesBesideSummary{kWaypoints, kTruth,     kAttitude,  kEstimate,  kGnss,
                                         kImages,    kObjects,   kPoses,     kKeypoints, kGallery,
                                         kManeuvers, kResiduals, kPacketLog, kReport};

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

fs::path picture_file(const fs::path& folder, const GalleryImage& image) {
  return folder / kPictures / fmt::format("{:05}.png", image.image);
}

void write_gallery(const fs::path& folder, const std::vector<GalleryImage>& gallery) {
  fs::create_directories(folder / kPictures);
  for (const GalleryImage& image : gallery)
    replace_text_file(picture_file(folder, image), std::string(image.png.begin(), image.png.end()));
  write_rows(folder / kGallery, gallery);
}

std::vector<GalleryImage> read_gallery(const fs::path& folder) {
  std::vector<GalleryImage> gallery = read_rows<GalleryImage>(folder / kGallery);
  for (GalleryImage& image : gallery) {
    const std::string bytes = read_text_file(picture_file(folder, image));
    image.png.assign(bytes.begin(), bytes.end());
  }
  return gallery;
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

RunFolder::RunFolder(fs::path folder, const Summary& start, Existing existing) : folder_(std::move(folder)) {
  try {
    check_may_be_used(folder_, existing);
    fs::create_directories(folder_);
    lock_.emplace(folder_);
    check_may_be_used(folder_, existing);  // another run may have come and gone before the lock was taken
    Summary running = start;
    running.complete = false;
    running.incomplete_reason = fmt::format("running in process {}, or killed", ::getpid());
    replace_text_file(folder_ / kSummary, summary_json(running, {}));
    for (const std::string_view name : kFilesBesideSummary) fs::remove(folder_ / name);
    fs::remove_all(folder_ / kPictures);
  } catch (const fs::filesystem_error& error) {
    fail(folder_, "cannot be made: " + error.code().message());
  }
}

void RunFolder::finish(const RunRecord& record) const {
  write_rows(folder_ / kWaypoints, record.waypoints);
  write_rows(folder_ / kTruth, record.truth);
  if (!record.attitudes.empty()) write_rows(folder_ / kAttitude, record.attitudes);
  write_rows(folder_ / kEstimate, record.estimates);
  if (!record.gnss.empty()) write_rows(folder_ / kGnss, record.gnss);
  if (!record.images.empty()) write_rows(folder_ / kImages, record.images);
  if (!record.objects.empty()) write_rows(folder_ / kObjects, record.objects);
  if (!record.poses.empty()) write_rows(folder_ / kPoses, record.poses);
  if (!record.keypoints.empty()) write_rows(folder_ / kKeypoints, record.keypoints);
  if (!record.gallery.empty()) write_gallery(folder_, record.gallery);
  write_rows(folder_ / kManeuvers, record.maneuvers);
  write_rows(folder_ / kResiduals, record.residuals);
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

RunRecord read_run(const fs::path& run_folder) {
  if (!fs::is_directory(run_folder)) fail(run_folder, "no such run folder");
  RunRecord record;
  record.summary = read_summary(run_folder / kSummary);
  // A run that was killed left nothing but its packet log.
  if (!record.summary.complete && !fs::exists(run_folder / kTruth)) {
    fail(run_folder,
         fmt::format("the run did not end (it says \"{}\") and left no tables", record.summary.incomplete_reason));
  }
  record.waypoints = read_rows<WaypointRow>(run_folder / kWaypoints);
  record.truth = read_rows<TruthRow>(run_folder / kTruth);
  if (fs::exists(run_folder / kAttitude)) record.attitudes = read_rows<AttitudeRow>(run_folder / kAttitude);
  record.estimates = read_rows<EstimateRow>(run_folder / kEstimate);
  if (fs::exists(run_folder / kGnss)) record.gnss = read_rows<GnssRow>(run_folder / kGnss);
  if (fs::exists(run_folder / kImages)) record.images = read_rows<ImageRow>(run_folder / kImages);
  if (fs::exists(run_folder / kObjects)) record.objects = read_rows<ObjectRow>(run_folder / kObjects);
  if (fs::exists(run_folder / kPoses)) record.poses = read_rows<PoseRow>(run_folder / kPoses);
  if (fs::exists(run_folder / kKeypoints)) record.keypoints = read_rows<KeypointRow>(run_folder / kKeypoints);
  if (fs::exists(run_folder / kGallery)) record.gallery = read_gallery(run_folder);
  record.maneuvers = read_rows<ManeuverRow>(run_folder / kManeuvers);
  record.residuals = read_rows<ResidualRow>(run_folder / kResiduals);
  return record;
}

}  // namespace vbar::report
