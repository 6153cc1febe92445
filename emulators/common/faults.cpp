#include "emulators/common/faults.h"

#include <stdexcept>

namespace vbar::emulators {

FaultLog::FaultLog(const std::filesystem::path& file) : file_(file) {
  if (!file_) throw std::runtime_error(file.string() + ": cannot be made");
}

void FaultLog::write(const std::string& line, const Acknowledge& acknowledge) {
  file_ << line << std::endl;
  if (acknowledge) acknowledge(line);
}

}  // namespace vbar::emulators
