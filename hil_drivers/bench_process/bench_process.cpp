#include "hil_drivers/bench_process/bench_process.h"

#include <array>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <system_error>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hil_drivers/bench_process/command_line.h"
#include "host_sim/io/process_limits.h"

namespace vbar::bench_process {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::seconds kStartLimit{30};
constexpr std::uint64_t kMemory = 32 * io::kBytesPerGib;  // several times that of the largest emulated bench
constexpr std::chrono::milliseconds kPoll{5};
constexpr std::chrono::milliseconds kEndPatience{3000};

fs::path make_directory() {
  std::string name = (fs::temp_directory_path() / "vbar_bench.XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr)
    throw std::runtime_error(name + ": cannot be made: " + std::generic_category().message(errno));
  return name;
}

}  // namespace

std::map<std::string, int> count_faults(const std::filesystem::path& file) {
  std::map<std::string, int> counts;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    const nlohmann::json json = nlohmann::json::parse(line, nullptr, false);
    const bool is_fault = json.is_object() && json.contains("kind") && json.at("kind").is_string();
    ++counts[is_fault ? json.at("kind").get<std::string>() : std::string("unknown")];
  }
  return counts;
}

std::vector<std::string> bench_arguments(const std::string& command_line, const fs::path& directory, std::uint64_t seed,
                                         const fs::path& data_directory) {
  const std::array<Replacement, 3> replacements{
      {{"{directory}", directory.string()}, {"{seed}", std::to_string(seed)}, {"{data}", data_directory.string()}}};
  std::vector<std::string> arguments = arguments_of(command_line, replacements);
  if (arguments.empty()) throw std::runtime_error("the command line of the bench names no program");
  return arguments;
}

BenchProcess::BenchProcess(const std::string& command_line, std::uint64_t seed, const fs::path& data_directory)
    : directory_(make_directory()) {
  try {
    arguments_ = bench_arguments(command_line, directory_, seed, fs::absolute(data_directory));
    for (const std::string& argument : arguments_)
      if (fs::is_regular_file(argument))
        if (auto digest = report::digest_of(argument)) files_.push_back(std::move(*digest));
    try {
      process_.emplace(arguments_, std::vector<io::FileDescriptor>{}, kMemory);
    } catch (const std::system_error& error) {
      throw std::runtime_error(fmt::format("bench {}: {}", arguments_.front(), error.code().message()));
    }
    wait_for_addresses();
  } catch (...) {
    stop();
    throw;
  }
}

BenchProcess::~BenchProcess() {
  stop();
}

void BenchProcess::wait_for_addresses() {
  const fs::path file = addresses_file();
  const auto until = std::chrono::steady_clock::now() + kStartLimit;
  while (!fs::exists(file)) {
    if (const auto end = end_report()) throw std::runtime_error(*end);
    if (std::chrono::steady_clock::now() >= until)
      throw std::runtime_error(fmt::format("bench {} did not write {} within {} s{}", arguments_.front(), file.string(),
                                           kStartLimit.count(), last_words()));
    std::this_thread::sleep_for(kPoll);
  }
}

std::optional<std::string> BenchProcess::end_report(std::chrono::milliseconds patience) {
  if (!process_ || !process_->wait_for_end(patience)) return std::nullopt;
  return fmt::format("bench {} has ended: {}{}", arguments_.front(), process_->status_text(), last_words());
}

/// Its last line.
std::string BenchProcess::last_words() const {
  std::string tail = process_ ? process_->output_tail(600) : "";
  while (!tail.empty() && (tail.back() == '\n' || tail.back() == ' ')) tail.pop_back();
  const std::size_t line = tail.rfind('\n');
  if (line != std::string::npos) tail.erase(0, line + 1);
  return tail.empty() ? "" : "; its last line: \"" + tail + "\"";
}

void BenchProcess::stop() noexcept {
  if (process_) process_->terminate(kEndPatience);
  if (directory_.empty()) return;
  try {
    faults_ = count_faults(directory_ / kFaultsFile);
  } catch (...) {
    // Without memory for a count the run still ends in order.
  }
  std::error_code ignored;
  fs::remove_all(directory_, ignored);
  directory_.clear();
}

}  // namespace vbar::bench_process
