#pragma once
// Any scheduler, by the command that starts a worker there.

#include <string>

#include "host_sim/campaign/engine.h"

namespace vbar::campaign {

/// Runs the template by a shell, once for each worker. In it {worker} is the worker's command line, {worker_word} the
/// same as one quoted word, {k} its number from 0 on, {n} how many there are; a template without a worker is refused.
[[nodiscard]] std::string submit_by_command(const Submission& submission);

/// The template of one worker with its names replaced. Throws app::Refused for an unknown name.
[[nodiscard]] std::string filled_template(const std::string& text, const std::string& worker, std::size_t k,
                                          std::size_t n);

}  // namespace vbar::campaign
