#pragma once
// The program, its data, flight images and mission files, copied once into the campaign's folder, so that neither a
// rebuild nor an edit during the campaign mixes two versions. Every worker checks their SHA-256.

#include <filesystem>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "host_sim/campaign/plan.h"

namespace vbar::campaign {

/// Files that the missions of a campaign use besides the data folder: absolute paths.
struct UsedFiles {
  std::filesystem::path mission;
  std::set<std::filesystem::path> beside_mission;  ///< that the mission names relative to itself
  std::set<std::filesystem::path> flight_images;   ///< images of flight computers in processes of their own
};

/// Copies all, writes bin/SHA256SUMS, which sha256sum -c reads. `mission_text` is the whole mission. Throws
/// std::runtime_error that names a file that cannot be copied.
void make_copies(const Folder& folder, const UsedFiles& files, const std::string& mission_text);

/// Returns the place of the mission's copy, relative to the campaign's folder. It stands at its own absolute path below
/// bin/files, as do all files that it names relative to itself.
[[nodiscard]] std::filesystem::path copy_of_mission(const std::filesystem::path& mission);

/// Reads the list of checksums: files, each with its SHA-256. Throws std::runtime_error that names the list.
[[nodiscard]] std::vector<std::pair<std::filesystem::path, std::string>> listed_copies(const Folder& folder);

/// "program", "data", "mission" or "flight image": what a copy is, for messages.
[[nodiscard]] std::string kind_of_copy(const Folder& folder, const std::filesystem::path& file);

/// Throws std::runtime_error that names the first file that is missing or differs.
void check_copies(const Folder& folder);

/// Whether this process can fly a case as well as a process of the copied program: it runs the same program, and there
/// is no flight image or library, which a program finds beside itself.
[[nodiscard]] bool flies_as_the_copy(const Folder& folder);

// Whether the flights of a campaign's folder would execute anything but this program. A folder may come from anywhere,
// and the list of checksums in it with it.

/// Throws app::Refused unless the folder is trusted, or its program, and what stands beside it, is that of this
/// installation, and its mission names no library, image, device, address or testbed.
void check_trust(const Folder& folder, const Plan& plan, const std::vector<Case>& cases, bool is_trusted);

}  // namespace vbar::campaign
