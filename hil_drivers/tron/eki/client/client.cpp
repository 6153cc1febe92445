#include "hil_drivers/tron/eki/client/client.h"

#include <span>

#include <fmt/format.h>

#include "host_sim/io/byte_channels.h"

namespace vbar::tron::eki {

Client::Client(const ClientSettings& settings)
    : settings_(settings), description_(fmt::format("{} at EKI {}:{}", settings.name, settings.host, settings.port)) {
  try {
    channel_ =
        io::connect_tcp(settings_.host, std::to_string(settings_.port), io::Clock::now() + settings_.connect_limit);
  } catch (const io::ChannelError& error) {
    fail(error.what());
  }
  (void)status();
}

Client::~Client() = default;

void Client::fail(const std::string& problem) const {
  throw EkiError(fmt::format("{}: {}", description_, problem));
}

void Client::send(Action action) {
  const std::string document = encode(Command{++seq_, action});
  try {
    channel_->write({reinterpret_cast<const std::uint8_t*>(document.data()), document.size()},
                    io::Clock::now() + settings_.answer_limit);
  } catch (const io::ChannelError& error) {
    fail(error.what());
  }
}

void Client::read(io::Clock::time_point deadline) {
  try {
    const auto bytes = channel_->read(deadline);
    documents_.append({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  } catch (const io::ChannelError& error) {
    fail(error.what());
  }
}

std::optional<Reply> Client::take() {
  try {
    while (const auto document = documents_.next()) {
      Reply reply = decode_reply(*document);
      const State* state = std::get_if<State>(&reply);
      if (state == nullptr) return reply;
      last_ = *state;
      if (state->seq != 0) return reply;
      ++unsolicited_;
    }
  } catch (const WireError& error) {
    fail(error.what());
  }
  return std::nullopt;
}

Reply Client::wait_for_reply(Action action) {
  const auto deadline = io::Clock::now() + settings_.answer_limit;
  while (true) {
    while (auto reply = take()) {
      const std::uint32_t seq = std::visit([](const auto& document) { return document.seq; }, *reply);
      if (seq == seq_) return *reply;  // others answer a command whose time was over
    }
    if (io::Clock::now() >= deadline)
      fail(fmt::format("no answer to \"{}\" within {} ms", name_of(action), settings_.answer_limit.count()));
    read(deadline);
  }
}

State Client::command(Action action) {
  send(action);
  const Reply reply = wait_for_reply(action);
  const State* state = std::get_if<State>(&reply);
  if (state == nullptr) fail(fmt::format("answers \"{}\" with a pose", name_of(action)));
  return *state;
}

RobotState Client::pose() {
  send(Action::kPose);
  const Reply reply = wait_for_reply(Action::kPose);
  const RobotState* state = std::get_if<RobotState>(&reply);
  if (state == nullptr) fail(fmt::format("reports no pose: \"{}\"", wire::printable(std::get<State>(reply).message)));
  return *state;
}

void Client::poll() {
  // An answer whose wait has ended is not used.
  const auto take_all = [this] {
    while (take()) {
    }
  };
  // States that came with the last answer are taken before a line that is closed is an error.
  const std::uint64_t before = unsolicited_;
  take_all();
  if (unsolicited_ != before) return;
  read(io::Clock::now());
  take_all();
}

}  // namespace vbar::tron::eki
