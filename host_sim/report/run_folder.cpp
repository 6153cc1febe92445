#include "host_sim/report/run_folder.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "host_sim/files/output_file.h"
#include "host_sim/report/run_tables.h"
#include "host_sim/report/summary_json.h"

namespace vbar::report {

namespace {

std::string process_in(int descriptor) {
  std::array<char, 32> text{};
  const ssize_t size = ::pread(descriptor, text.data(), text.size() - 1, 0);
  return size > 0 ? std::string(text.data(), static_cast<std::size_t>(size)) : "of an unknown number";
}

/// Whether the open file is still the one of that name: its last holder may have removed it meanwhile.
bool is_current(int descriptor, const std::filesystem::path& file) {
  struct stat held {
  }, named{};
  return ::fstat(descriptor, &held) == 0 && ::stat(file.c_str(), &named) == 0 && held.st_ino == named.st_ino &&
         held.st_dev == named.st_dev;
}

}  // namespace

RunLock::RunLock(const std::filesystem::path& folder) : file_(folder / kFile) {
  files::remove_link(file_);
  while (descriptor_ < 0) {
    const int descriptor = ::open(file_.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0644);
    if (descriptor < 0)
      throw std::runtime_error(file_.string() + ": cannot be written: " + std::generic_category().message(errno));
    if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
      const int error = errno;
      const std::string process = process_in(descriptor);
      ::close(descriptor);
      if (error == EWOULDBLOCK)
        throw FolderRefused(folder.string() + ": is being written by a run in process " + process);
      throw std::runtime_error(file_.string() + ": cannot be locked: " + std::generic_category().message(error));
    }
    if (is_current(descriptor, file_))
      descriptor_ = descriptor;
    else
      ::close(descriptor);
  }
  const std::string process = std::to_string(::getpid());
  // The number only serves the message of another run; on a full disk it is missing.
  if (::ftruncate(descriptor_, 0) == 0) static_cast<void>(!::write(descriptor_, process.data(), process.size()));
}

RunLock::~RunLock() {
  if (is_current(descriptor_, file_)) ::unlink(file_.c_str());  // the folder may have been replaced
  ::close(descriptor_);
}

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kSummary = "summary.json";
constexpr std::string_view kPictures = "gallery";  // a folder
constexpr std::string_view kPacketLog = "packets.lcmlog";
constexpr std::string_view kReport = "report.html";
constexpr std::string_view kView = "view.html";

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
  files::replace_text_file(file, std::string(png.begin(), png.end()));
}

std::vector<std::uint8_t> read_picture(const fs::path& file) {
  const std::string bytes = files::read_text_file(file);
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
fs::path view_file(const fs::path& run_folder) {
  return run_folder / kView;
}

std::vector<std::string> flight_files(Extensions extensions) {
  std::vector<std::string> names{std::string(kPacketLog), std::string(kPictures)};
  std::vector<std::string> whole = table_files(extensions);
  whole.insert(whole.end(), {std::string(kReport), std::string(kView)});
  for (const std::string& name : whole)
    names.insert(names.end(), {name, files::PartialFile::part_of(name).string(), files::neighbour_of(name).string()});
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
    files::replace_text_file(folder_ / kSummary, summary_json(running, {}));
    for (const std::string& name : flight_files(extensions)) fs::remove_all(folder_ / name);
    keep_room_for_summary();
  } catch (const fs::filesystem_error& error) {
    fail(folder_, "cannot be made: " + error.code().message());
  }
}

/// Reserves space in the file from which the last summary takes its name: a disk that fills in flight leaves space to
/// say so.
void RunFolder::keep_room_for_summary() const {
  constexpr off_t kRoom = 128 * 1024;  // several summaries of a long mission
  const fs::path neighbour = files::neighbour_of(folder_ / kSummary);
  files::remove_link(neighbour);
  const int descriptor = ::open(neighbour.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, 0644);
  if (descriptor < 0) return;
  const bool has_room = ::posix_fallocate(descriptor, 0, kRoom) == 0;
  ::close(descriptor);
  std::error_code ignored;
  if (!has_room) fs::remove(neighbour, ignored);
}

void RunFolder::update(const RunRecord& record) {
  if (with_tables_) tables_.update(record);
}

void RunFolder::finish(const RunRecord& record) {
  if (with_tables_) {
    write_pictures(folder_, record.gallery);
    tables_.finish(record);
  }
  files::replace_text_file(folder_ / kSummary, summary_json(record.summary, record.waypoints));
}

void RunFolder::give_up(Summary summary, const std::string& reason) const {
  summary.complete = false;
  summary.incomplete_reason = reason;
  try {
    files::replace_text_file(folder_ / kSummary, summary_json(summary, {}));
  } catch (const std::runtime_error&) {
    // The summary of the start is whole.
  }
}

RunRecord read_run(const fs::path& run_folder, Extensions extensions) {
  if (!fs::is_directory(run_folder)) fail(run_folder, "no such run folder");
  RunRecord record;
  record.extensions = extensions;
  record.summary = read_summary(run_folder / kSummary);
  const fs::path truth = run_folder / "truth.csv";
  if (!record.summary.complete && !fs::exists(truth) && !fs::exists(files::PartialFile::part_of(truth))) {
    fail(run_folder,
         fmt::format("the run did not end (it says \"{}\") and left no tables", record.summary.incomplete_reason));
  }
  read_tables(run_folder, record);
  if (!fs::exists(run_folder / kPictures) && !record.summary.complete) record.gallery.clear();  // written at the end
  read_pictures(run_folder, record.gallery);
  return record;
}

}  // namespace vbar::report
