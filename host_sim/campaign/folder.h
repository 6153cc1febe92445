#pragma once
// The files of a campaign's folder.

#include <filesystem>
#include <string>
#include <vector>

namespace vbar::campaign {

class Folder {
 public:
  explicit Folder(std::filesystem::path root) : root_(std::move(root)) {}

  [[nodiscard]] const std::filesystem::path& root() const { return root_; }
  [[nodiscard]] std::filesystem::path campaign_copy() const { return root_ / "campaign.toml"; }
  [[nodiscard]] std::filesystem::path plan() const { return root_ / "campaign.json"; }
  [[nodiscard]] std::filesystem::path cases() const { return root_ / "cases.csv"; }
  [[nodiscard]] std::filesystem::path results() const { return root_ / "results.csv"; }
  /// A file for each worker: a line for each case that it finished.
  [[nodiscard]] std::filesystem::path result_files() const { return root_ / "results"; }
  /// A file for each worker: a line for each flight that it began, and for each that was killed.
  [[nodiscard]] std::filesystem::path attempt_files() const { return root_ / "attempts"; }
  /// The run folders of cases that are being flown, one for each attempt.
  [[nodiscard]] std::filesystem::path flying() const { return root_ / "flying"; }
  /// The run folders that are kept.
  [[nodiscard]] std::filesystem::path runs() const { return root_ / "runs"; }
  /// Program, data, images and mission as they were when the campaign was made.
  [[nodiscard]] std::filesystem::path copies() const { return root_ / "bin"; }
  [[nodiscard]] std::filesystem::path program() const { return copies() / "host" / "vbar"; }
  [[nodiscard]] std::filesystem::path data() const { return copies() / "data"; }
  [[nodiscard]] std::filesystem::path mission_files() const { return copies() / "files"; }
  [[nodiscard]] std::filesystem::path checksums() const { return copies() / "SHA256SUMS"; }
  /// Returns the folder of the lists of cases for the workers of one submission, and of their output.
  [[nodiscard]] std::filesystem::path submissions() const { return root_ / "submissions"; }

  /// Throws app::Refused unless the folder holds a campaign.
  void require_campaign() const;

  /// Throws app::Refused if a folder within is a symbolic link: what is written and removed in it would be elsewhere.
  void refuse_links() const;

 private:
  std::filesystem::path root_;
};

/// The files `*.jsonl` of a folder in order of their names; none if it does not exist.
[[nodiscard]] std::vector<std::filesystem::path> record_files(const std::filesystem::path& folder);

}  // namespace vbar::campaign
