#include "host_sim/report/provenance.h"

#include <utility>

#include "host_sim/files/sha256.h"

namespace vbar::report {

std::optional<FileDigest> digest_of(const std::filesystem::path& file) {
  auto sha256 = files::sha256_of_file(file);
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(file, error);
  if (!sha256 || error) return std::nullopt;
  return FileDigest{file.string(), bytes, std::move(*sha256)};
}

}  // namespace vbar::report
