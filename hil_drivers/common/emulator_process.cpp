#include "hil_drivers/common/emulator_process.h"

#include <array>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>

#include "host_sim/files/own_program.h"
#include "host_sim/files/text_lines.h"
#include "host_sim/io/child_process.h"
#include "host_sim/mission/mission_error.h"

namespace vbar::testbeds {

namespace {

/// The words that start a program.
std::vector<std::string> start_of(const std::string& name) {
  if (name.find('/') != std::string::npos) return {name};
  std::error_code ignored;
  const auto beside = files::own_program().parent_path() / name;
  return std::filesystem::exists(beside, ignored) ? files::words_that_start(beside) : std::vector{name};
}

}  // namespace

std::vector<std::string> arguments_of(const std::string& command_line, std::span<const Replacement> replacements) {
  std::vector<std::string> arguments;
  std::istringstream words(command_line);
  for (std::string word; words >> word;) {
    for (const auto& [what, by] : replacements) word = files::replaced(std::move(word), what, by);
    arguments.push_back(word);
  }
  if (arguments.empty()) return arguments;
  std::vector<std::string> started = start_of(arguments.front());
  started.insert(started.end(), arguments.begin() + 1, arguments.end());
  return started;
}

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

std::map<std::string, double> read_counters(const std::filesystem::path& file) {
  std::map<std::string, double> counters;
  std::ifstream stream(file);
  const nlohmann::json json = nlohmann::json::parse(stream, nullptr, false);
  if (!json.is_object()) return counters;
  for (const auto& [name, value] : json.items())
    if (value.is_number()) counters.emplace(name, value.get<double>());
  return counters;
}

std::vector<std::string> emulator_arguments(const std::string& command_line, const fs::path& directory,
                                            std::uint64_t seed, const fs::path& data_directory) {
  const std::array<Replacement, 3> replacements{
      {{"{directory}", directory.string()}, {"{seed}", std::to_string(seed)}, {"{data}", data_directory.string()}}};
  std::vector<std::string> arguments = arguments_of(command_line, replacements);
  if (arguments.empty()) throw std::runtime_error("the command line of the bench names no program");
  return arguments;
}

EmulatorProcess::EmulatorProcess(const std::string& command_line, std::uint64_t seed, const fs::path& data_directory)
    : directory_(make_directory()) {
  try {
    arguments_ = emulator_arguments(command_line, directory_, seed, fs::absolute(data_directory));
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

EmulatorProcess::~EmulatorProcess() {
  stop();
}

void EmulatorProcess::wait_for_addresses() {
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

std::optional<std::string> EmulatorProcess::end_report(std::chrono::milliseconds patience) {
  if (!process_ || !process_->wait_for_end(patience)) return std::nullopt;
  return fmt::format("bench {} has ended: {}{}", arguments_.front(), process_->status_text(), last_words());
}

/// Its last line.
std::string EmulatorProcess::last_words() const {
  std::string tail = process_ ? process_->output_tail(600) : "";
  while (!tail.empty() && (tail.back() == '\n' || tail.back() == ' ')) tail.pop_back();
  const std::size_t line = tail.rfind('\n');
  if (line != std::string::npos) tail.erase(0, line + 1);
  return tail.empty() ? "" : "; its last line: \"" + tail + "\"";
}

// The process remains to be reaped by its owner, whose report has its status and last words.
void EmulatorProcess::watch(std::function<void()> on_end) {
  watch_ = std::jthread([pid = process_->pid(), on_end = std::move(on_end)](const std::stop_token& stopped) {
    constexpr std::chrono::milliseconds kBetweenLooks{200};
    while (!stopped.stop_requested()) {
      siginfo_t info{};
      const bool is_reaped = ::waitid(P_PID, static_cast<id_t>(pid), &info, WEXITED | WNOHANG | WNOWAIT) != 0;
      if (is_reaped || info.si_pid == pid) return stopped.stop_requested() ? void() : on_end();
      std::this_thread::sleep_for(kBetweenLooks);
    }
  });
}

void EmulatorProcess::stop() noexcept {
  end_watch();
  if (process_) process_->terminate(kEndPatience);
  if (directory_.empty()) return;
  try {
    faults_ = count_faults(directory_ / wire::kFaultsFile);
    counters_ = read_counters(directory_ / wire::kCountersFile);
  } catch (...) {
    // Without memory for a count the run still ends in order.
  }
  std::error_code ignored;
  fs::remove_all(directory_, ignored);
  directory_.clear();
}

std::filesystem::path find_calibration_file(const std::string& path, const std::filesystem::path& data_directory,
                                            std::uint64_t seed, const CalibrationCommand& made_by) {
  const std::filesystem::path file =
      files::replaced(files::replaced(path, "{data}", data_directory.string()), "{seed}", std::to_string(seed));
  std::error_code error;
  if (std::filesystem::exists(file, error)) return file;
  if (std::filesystem::path bundled = data_directory / file; std::filesystem::exists(bundled, error)) return bundled;
  // The placeholders of the bench's own command line stay.
  const std::string command =
      files::replaced(files::replaced(made_by.command, "{N}", std::to_string(seed)), "{out}", file.string());
  throw mission::MissionError(
      file.string(), std::string(made_by.testbed) + ".calibration",
      "no such file here, nor in " + data_directory.string(),
      "a calibration of this bench, made in " + std::string(made_by.duration) + " by: " + command);
}

}  // namespace vbar::testbeds
