#include "host_sim/campaign/folder.h"

#include <algorithm>
#include <system_error>

#include "host_sim/app/exit_codes.h"

namespace vbar::campaign {

void Folder::require_campaign() const {
  std::error_code error;
  if (!std::filesystem::is_regular_file(plan(), error))
    throw app::Refused(root_.string() +
                       ": is not the folder of a campaign; accepted: one that vbar campaign run FILE made");
  refuse_links();
}

void Folder::refuse_links() const {
  for (const std::filesystem::path& inner :
       {result_files(), attempt_files(), flying(), runs(), copies(), submissions()}) {
    std::error_code error;
    if (std::filesystem::is_symlink(std::filesystem::symlink_status(inner, error)))
      throw app::Refused(inner.string() +
                         ": is a symbolic link; accepted: a folder, or the whole campaign's folder behind a link");
  }
}

std::vector<std::filesystem::path> record_files(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (entry.path().extension() == ".jsonl") files.push_back(entry.path());
  std::ranges::sort(files);
  return files;
}

}  // namespace vbar::campaign
