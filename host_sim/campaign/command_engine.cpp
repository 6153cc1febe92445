#include "host_sim/campaign/command_engine.h"

#include <array>
#include <utility>

#include <fmt/format.h>

#include "host_sim/app/exit_codes.h"
#include "host_sim/campaign/shell.h"

namespace vbar::campaign {

std::string filled_template(const std::string& text, const std::string& worker, std::size_t k, std::size_t n) {
  const std::array<std::pair<std::string, std::string>, 4> names{{{"{worker}", worker},
                                                                  {"{worker_word}", shell_word(worker)},
                                                                  {"{k}", std::to_string(k)},
                                                                  {"{n}", std::to_string(n)}}};
  std::string filled;
  bool has_worker = false;
  for (std::size_t place = 0; place < text.size();) {
    const auto named = [&]() -> const std::pair<std::string, std::string>* {
      for (const auto& one : names)
        if (text.compare(place, one.first.size(), one.first) == 0) return &one;
      return nullptr;
    }();
    if (named == nullptr) {
      filled += text[place++];
      continue;
    }
    has_worker = has_worker || named->first.starts_with("{worker");
    filled += named->second;
    place += named->first.size();
  }
  if (!has_worker)
    throw app::Refused(
        "--submit: found a template without a worker; accepted: a command line with {worker} or "
        "{worker_word}, and {k}, {n}");
  return filled;
}

std::string submit_by_command(const Submission& submission) {
  for (std::size_t k = 0; k < submission.workers; ++k) {
    const std::string command =
        filled_template(submission.options, submission.worker_command(std::to_string(k)), k, submission.workers);
    const CommandResult result = run_command({"/bin/sh", "-c", command});
    if (!result.succeeded)
      throw app::Refused(fmt::format("worker {} of {} is not taken: {}", k, submission.workers, result.trouble));
  }
  return fmt::format("{} workers submitted for {} cases", submission.workers, submission.cases.size());
}

}  // namespace vbar::campaign
