#pragma once
// The control line of the faults: a Unix stream socket. Each line that comes in is one JSON object with the keys of
// [[fault]] in a scenario file. The answer is one line: {"injected": {...}} when the fault has taken effect, or
// {"error": "..."}.

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>

#include "hil_drivers/grand/bench/generator/fault_injector.h"

namespace vbar::grand::bench {

class FaultLine {
 public:
  /// Throws std::runtime_error if the socket cannot be made.
  FaultLine(boost::asio::io_context& context, FaultInjector& injector, std::vector<std::string> vehicles,
            const std::filesystem::path& path);
  ~FaultLine();
  FaultLine(const FaultLine&) = delete;
  FaultLine& operator=(const FaultLine&) = delete;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace vbar::grand::bench
