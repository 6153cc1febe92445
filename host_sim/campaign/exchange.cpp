#include "host_sim/campaign/exchange.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "host_sim/campaign/case_records.h"
#include "host_sim/campaign/copies.h"
#include "host_sim/campaign/engine.h"
#include "host_sim/campaign/status.h"
#include "host_sim/campaign/worker.h"
#include "host_sim/campaign_report/page.h"
#include "host_sim/files/output_file.h"
#include "host_sim/simulation/exit_codes.h"

namespace vbar::campaign {

namespace {

namespace fs = std::filesystem;
using app::Refused;

constexpr std::chrono::seconds kArchiveLimit{900};

// Plain shell: the other computer may have nothing but a shell and a portable bundle. The program that was started
// loads the libraries, and flies the program of this folder, whose checksum the results are of.
constexpr const char* kScript = R"(#!/bin/sh
# Flies the cases of this campaign that have no result yet, and packs the results for vbar campaign import.
#   ./fly.sh [VBAR [OPTION...]]    VBAR: that of an unpacked portable bundle, or an installed one; OPTION: of vbar campaign run
case $0 in */*) here=${0%/*} ;; *) here=. ;; esac
here=$(cd "$here" && pwd) || exit 1
vbar=${1:-$here/bin/host/vbar}; [ $# -eq 0 ] || shift
"$vbar" campaign run "$here" --trust "$@"; code=$?
tar -C "$here" -czf "$here/results.tar.gz" campaign.json cases.csv bin/SHA256SUMS results && echo "results  $here/results.tar.gz"
exit $code
)";

/// A folder that is removed with all its contents when this object ends.
class ScratchFolder {
 public:
  explicit ScratchFolder(fs::path path) : path_(std::move(path)) {
    std::error_code error;
    if (!fs::create_directory(path_, error))
      throw std::runtime_error(
          fmt::format("{}: cannot be made: {}", path_.string(), error ? error.message() : "it exists"));
  }
  ~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

bool is_archive(const fs::path& file) {
  return file.extension() == ".tgz" || file.string().ends_with(".tar.gz");
}

/// The whole campaign but for run folders and what workers leave while they fly.
void copy_campaign(const Folder& from, const Folder& to) {
  try {
    for (const fs::path& inner : {to.attempt_files(), to.flying()}) fs::create_directory(inner);
    fs::copy(from.copies(), to.copies(), fs::copy_options::recursive);
    fs::copy(from.result_files(), to.result_files(), fs::copy_options::recursive);
    fs::copy_file(from.cases(), to.cases());
    fs::copy_file(from.campaign_copy(), to.campaign_copy());
    fs::copy_file(from.plan(), to.plan());
    files::replace_text_file(to.root() / kFlyScript, kScript);
    fs::permissions(to.root() / kFlyScript, fs::perms::owner_exec | fs::perms::group_exec | fs::perms::others_exec,
                    fs::perm_options::add);
  } catch (const fs::filesystem_error& error) {
    throw std::runtime_error(fmt::format("{}: cannot be written: {}", to.root().string(), error.code().message()));
  }
}

/// The first line of what a program said, as the reason in a sentence.
std::string first_line(const std::string& text) {
  return text.substr(0, text.find('\n'));
}

}  // namespace

Exported export_cases(const Folder& folder, fs::path to) {
  const Standing standing = read_standing(folder);
  check_copies(folder);
  const std::size_t left = standing.left_to_fly(false).size();
  if (left == 0) throw Refused(folder.root().string() + ": every case has its result; nothing is left to export");
  const std::string name = campaign_report::name_of_folder(folder.root());
  if (to.empty()) to = name + "-cases.tar.gz";
  std::error_code error;
  if (fs::exists(fs::symlink_status(to, error))) throw Refused(to.string() + ": exists; name another one with --to");
  const fs::path part = files::neighbour_of(to);
  const ScratchFolder stage(is_archive(to) ? fs::path(part.string() + ".folder") : part);
  fs::path made = stage.path() / name;
  fs::create_directory(made);
  copy_campaign(folder, Folder(made));
  if (is_archive(to)) {
    const CommandResult packed =
        run_command({"tar", "--create", "--gzip", "--file", part.string(), "--directory", stage.path().string(), name},
                    kArchiveLimit);
    if (!packed.succeeded) {
      fs::remove(part, error);
      throw std::runtime_error(fmt::format("{}: cannot be written: {}", to.string(), first_line(packed.trouble)));
    }
    made = part;
  }
  fs::rename(made, to, error);
  if (error) throw std::runtime_error(fmt::format("{}: cannot be written: {}", to.string(), error.message()));
  return {std::move(to), left};
}

namespace {

/// The folder of the campaign in an unpacked archive: itself, or one in it.
Folder campaign_in(const fs::path& unpacked) {
  for (const auto& entry : fs::directory_iterator(unpacked))
    if (entry.is_directory() && fs::exists(Folder(entry.path()).plan())) return Folder(entry.path());
  return Folder(unpacked);
}

/// Only what the import reads is unpacked. A missing part is an error of tar's, as is an archive that was cut.
void unpack(const fs::path& archive, const fs::path& to) {
  const CommandResult unpacked = run_command({"tar", "--extract", "--gzip", "--file", fs::absolute(archive).string(),
                                              "--directory", to.string(), "--no-same-owner", "--no-same-permissions",
                                              "--no-anchored", "campaign.json", "cases.csv", "SHA256SUMS", "results"},
                                             kArchiveLimit);
  if (!unpacked.succeeded)
    throw Refused(fmt::format("{}: is not a whole archive of results ({}); nothing was imported", archive.string(),
                              first_line(unpacked.trouble)));
}

[[noreturn]] void refuse(const fs::path& from, const std::string& what) {
  throw Refused(fmt::format("{}: {}; nothing was imported", from.string(), what));
}

/// Refuses copies other than those of the campaign, by the first one that differs.
void compare_copies(const Folder& own, const Folder& other, const fs::path& from) {
  std::map<fs::path, std::string> listed;
  for (const auto& [file, sha256] : listed_copies(other)) listed[file.lexically_relative(other.copies())] = sha256;
  for (const auto& [file, sha256] : listed_copies(own)) {
    const fs::path relative = file.lexically_relative(own.copies());
    const auto found = listed.find(relative);
    if (found == listed.end() || found->second != sha256)
      refuse(from, fmt::format("its {} is not that of this campaign ({}: SHA-256 {}, here {})", kind_of_copy(own, file),
                               relative.string(), found == listed.end() ? "missing" : found->second.substr(0, 16),
                               sha256.substr(0, 16)));
    listed.erase(found);
  }
  if (!listed.empty())
    refuse(from, fmt::format("it has a {} that this campaign has not ({})",
                             kind_of_copy(own, own.copies() / listed.begin()->first), listed.begin()->first.string()));
}

/// The results of `other` that are to be added here.
std::vector<Result> new_results(const Standing& own, const Standing& other, const fs::path& from, Imported& imported) {
  std::vector<Result> added;
  for (const auto& [number, result] : other.results.of_case) {
    const auto has_flown = [](const Result& one) { return one.state == State::kComplete || one.state == State::kVoid; };
    if (result.state == State::kLost) continue;  // says nothing of the case; it is flown here
    const auto before = own.results.of_case.find(number);
    const bool is_known = before != own.results.of_case.end() && (has_flown(before->second) || !has_flown(result));
    if (!is_known) {
      added.push_back(result);
      added.back().folder.clear();  // run folders stay where they were flown
    } else if (has_flown(before->second) && has_flown(result) && !before->second.has_same_outputs(result)) {
      refuse(from, fmt::format("case {} has other outputs, on {} ({}), than on record, on {} ({})", number, result.host,
                               result.processor, before->second.host, before->second.processor));
    } else {
      ++imported.known;
    }
  }
  return added;
}

void add_results(const Folder& folder, const std::vector<Result>& results) {
  if (results.empty()) return;
  const std::string name = new_worker_name("import") + ".jsonl";
  for (const fs::path& inner : {folder.attempt_files(), folder.result_files()}) fs::create_directories(inner);
  RecordFile attempts(folder.attempt_files() / name);
  ResultFile file(folder.result_files() / name);
  for (const Result& result : results) {
    attempts.append(begin_line(result.number, result.attempt, result.host, 0), RecordFile::Sync::kNo);
    file.append(result);
  }
}

Imported import_from(const Folder& folder, const Folder& other, const fs::path& from) {
  other.require_campaign();
  const Standing own = read_standing(folder);
  compare_copies(folder, other, from);
  if (read_plan(other.plan()).cases_sha256 != own.plan.cases_sha256)
    refuse(from, "its cases are not those of this campaign (SHA-256 of cases.csv)");
  const Standing there = read_standing(other);
  if (there.results.damaged_lines > 0)
    refuse(from, fmt::format("{} lines of its results are damaged", there.results.damaged_lines));
  if (!there.results.conflicts.empty()) refuse(from, there.results.conflicts.front());
  for (const auto& [number, result] : there.results.of_case)
    if (result.case_sha256 != identity_of(own.plan, own.cases[number]))
      refuse(from, fmt::format("case {} was flown with other keys than those of this campaign", number));
  Imported imported;
  const std::vector<Result> added = new_results(own, there, from, imported);
  add_results(folder, added);
  imported.taken = added.size();
  imported.left = read_standing(folder).left_to_fly(false).size();
  return imported;
}

}  // namespace

Imported import_results(const Folder& folder, const fs::path& from) {
  folder.require_campaign();
  std::error_code error;
  if (fs::is_directory(from, error)) return import_from(folder, Folder(from), from);
  if (!fs::is_regular_file(from, error))
    throw Refused(from.string() +
                  ": cannot be read; accepted: an exported folder that was flown, or its results.tar.gz");
  const ScratchFolder scratch(folder.root() / (new_worker_name("import") + ".part"));
  unpack(from, scratch.path());
  return import_from(folder, campaign_in(scratch.path()), from);
}

}  // namespace vbar::campaign
