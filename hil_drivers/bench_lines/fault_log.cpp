#include "hil_drivers/bench_lines/fault_log.h"

#include <stdexcept>

namespace vbar::bench_lines {

FaultLog::FaultLog(const std::filesystem::path& file) : file_(file) {
  if (!file_) throw std::runtime_error(file.string() + ": cannot be made");
}

void FaultLog::write(const std::string& line, const Acknowledge& acknowledge) {
  file_ << line << std::endl;
  if (acknowledge) acknowledge(line);
}

}  // namespace vbar::bench_lines
