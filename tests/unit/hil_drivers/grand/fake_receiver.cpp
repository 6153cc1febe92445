#include "tests/unit/hil_drivers/grand/fake_receiver.h"

#include <array>
#include <filesystem>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

namespace vbar::grand {
namespace {

unsigned number_of(speed_t speed) {
  switch (speed) {
    case B2400:
      return 2400;
    case B4800:
      return 4800;
    case B9600:
      return 9600;
    case B19200:
      return 19200;
    case B38400:
      return 38400;
    case B57600:
      return 57600;
    case B115200:
      return 115200;
    case B230400:
      return 230400;
    case B460800:
      return 460800;
    default:
      return 0;
  }
}

}  // namespace

FakeReceiver::FakeReceiver(Behaviour behaviour) : behaviour_(std::move(behaviour)), baud_(behaviour_.baud) {
  std::string name = (std::filesystem::temp_directory_path() / "fake_receiver.XXXXXX").string();
  directory_ = ::mkdtemp(name.data());
  device_ = directory_ + "/com1";
  come_back();
}

FakeReceiver::~FakeReceiver() {
  hang_up();
  std::error_code ignored;
  std::filesystem::remove_all(directory_, ignored);
}

void FakeReceiver::come_back() {
  pty_ = io::make_pty();
  ::fcntl(pty_.master.get(), F_SETFL, O_NONBLOCK);
  std::filesystem::create_symlink(pty_.slave_path, device_);
  ends_ = false;
  thread_ = std::thread([this] { serve(); });
}

void FakeReceiver::hang_up() {
  if (!thread_.joinable()) return;
  ends_ = true;
  thread_.join();
  std::filesystem::remove(device_);
  pty_ = {};
}

bool FakeReceiver::rates_agree() const {
  termios settings{};
  ::tcgetattr(pty_.master.get(), &settings);
  return number_of(::cfgetospeed(&settings)) == baud_;
}

void FakeReceiver::serve() {
  while (!ends_) {
    pollfd entry{pty_.master.get(), POLLIN, 0};
    if (::poll(&entry, 1, 5) <= 0) continue;
    std::array<std::uint8_t, 256> buffer;
    const ssize_t count = ::read(pty_.master.get(), buffer.data(), buffer.size());
    for (ssize_t k = 0; k < count; ++k) hear(rates_agree() ? buffer[static_cast<std::size_t>(k)] : std::uint8_t{0xF8});
  }
}

void FakeReceiver::hear(std::uint8_t byte) {
  if (byte != '\r') {
    line_ += static_cast<char>(byte);
    return;
  }
  const std::string command = std::exchange(line_, {});
  if (!command.empty()) execute(command);
}

void FakeReceiver::execute(const std::string& command) {
  if (command.find('\xF8') != std::string::npos) return answer("<ERROR:Message is incorrect for this command");
  const auto of = [&](const auto& table) {
    return std::find_if(table.begin(), table.end(),
                        [&](const auto& entry) { return command.starts_with(entry.first); });
  };
  {
    const std::lock_guard lock(mutex_);
    if (command.find("VERSIONB") == std::string::npos) commands_.push_back(command);
  }
  const auto special = of(behaviour_.answers);
  const std::string text = special == behaviour_.answers.end() ? "<OK" : special->second;
  if (behaviour_.sends_garbage_before_answers) send({0x00, 0xAA, 0x44, '<', 'O', 0x12, 0xFF, '['});
  if (!text.empty()) answer(text);
  if (command.starts_with("SERIALCONFIG")) baud_ = static_cast<unsigned>(std::stoul(command.substr(22)));
  if (command == "RESET") baud_ = behaviour_.baud_after_reset;
  if (const auto log = of(behaviour_.logs); log != behaviour_.logs.end()) send(log->second);
}

void FakeReceiver::answer(const std::string& text) {
  const std::string whole = "\r\n" + text + "\r\n[COM1]";
  send({whole.begin(), whole.end()});
}

void FakeReceiver::send(const std::vector<std::uint8_t>& bytes) {
  std::vector<std::uint8_t> on_the_line = bytes;
  if (!rates_agree()) std::fill(on_the_line.begin(), on_the_line.end(), std::uint8_t{0x80});
  const ssize_t written = ::write(pty_.master.get(), on_the_line.data(), on_the_line.size());
  EXPECT_EQ(written, static_cast<ssize_t>(on_the_line.size()));
}

std::vector<std::string> FakeReceiver::commands() {
  const std::lock_guard lock(mutex_);
  return commands_;
}

}  // namespace vbar::grand
