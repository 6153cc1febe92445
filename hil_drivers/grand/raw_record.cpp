#include "hil_drivers/grand/raw_record.h"

#include <stdexcept>

#include "host_sim/files/remove_link.h"

namespace vbar::grand {

void RawRecord::add(std::span<const std::uint8_t> bytes) {
  const std::lock_guard lock(mutex_);
  if (file_.is_open()) {
    write(bytes);
  } else {
    early_.insert(early_.end(), bytes.begin(), bytes.end());
  }
}

void RawRecord::keep_in(const std::filesystem::path& file) {
  const std::lock_guard lock(mutex_);
  path_ = file;
  files::remove_link(file);
  file_.open(file, std::ios::binary | std::ios::trunc);
  if (!file_) throw std::runtime_error(file.string() + ": cannot be written");
  write(early_);
  early_.clear();
}

void RawRecord::flush() {
  const std::lock_guard lock(mutex_);
  if (file_.is_open()) file_.flush();
}

void RawRecord::write(std::span<const std::uint8_t> bytes) {
  file_.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!file_) throw std::runtime_error(path_.string() + ": cannot be written");
}

}  // namespace vbar::grand
