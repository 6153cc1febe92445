#include "hil_drivers/tron/protocols/eki.h"

#include <limits>
#include <span>

#include <fmt/format.h>

#include "hil_drivers/tron/protocols/kuka_xml.h"
#include "host_sim/io/byte_channel.h"

namespace vbar::tron::eki {

namespace {

constexpr std::string_view kBlanks = " \t\r\n";

/// Position behind the '>' that ends the tag at `begin`, quoted attribute values skipped; npos: not yet there.
std::size_t end_of_tag(std::string_view text, std::size_t begin) {
  char quote = 0;
  for (std::size_t k = begin; k < text.size(); ++k) {
    const char c = text[k];
    if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '>') {
      return k + 1;
    }
  }
  return std::string_view::npos;
}

/// Length of the document at the beginning of `text`, which begins with '<'; 0: not complete.
std::size_t document_length(std::string_view text) {
  const std::size_t name_end = text.find_first_of(" \t\r\n/>", 1);
  const std::size_t tag_end = end_of_tag(text, 0);
  if (name_end == std::string_view::npos || tag_end == std::string_view::npos) return 0;
  if (text[tag_end - 2] == '/') return tag_end;
  const std::string closing = fmt::format("</{}", text.substr(1, name_end - 1));
  for (std::size_t at = text.find(closing, tag_end); at != std::string_view::npos; at = text.find(closing, at + 1)) {
    const std::size_t end = text.find_first_not_of(kBlanks, at + closing.size());
    if (end == std::string_view::npos) return 0;
    if (text[end] == '>') return end + 1;
  }
  return 0;
}

}  // namespace

std::optional<std::string> DocumentBuffer::next() {
  // A controller pads blocks with zeros; blanks between documents are allowed.
  const std::size_t begin = buffer_.find_first_not_of(std::string_view("\0 \t\r\n", 5));
  buffer_.erase(0, begin);
  if (buffer_.empty()) return std::nullopt;
  const auto discard = [&](const std::string& problem) {
    buffer_.clear();
    throw WireError(problem);
  };
  if (buffer_.front() != '<') discard(fmt::format("\"{}\" does not begin a document", wire::printable(buffer_)));
  const std::size_t length = document_length(std::string_view(buffer_).substr(0, kMaxDocumentBytes));
  if (length == 0) {
    if (buffer_.size() >= kMaxDocumentBytes)
      discard(fmt::format("a document does not end within {} bytes", kMaxDocumentBytes));
    return std::nullopt;
  }
  std::string document = buffer_.substr(0, length);
  buffer_.erase(0, length);
  return document;
}

namespace {

constexpr int kDecimals = 4;
constexpr std::size_t kMaxMessageCharacters = 256;
struct ActionName {
  Action action;
  std::string_view name;
};
constexpr std::array<ActionName, 5> kActions{{{Action::kStatus, "status"},
                                              {Action::kStart, "start"},
                                              {Action::kStop, "stop"},
                                              {Action::kReset, "reset"},
                                              {Action::kPose, "pose"}}};

class Reader {
 public:
  explicit Reader(std::string_view text) : text_(text) {
    if (!document_.parse(text, kMaxDocumentBytes)) fail(document_.problem());
  }

  [[nodiscard]] pugi::xml_node root() const { return document_.root(); }

  [[nodiscard]] std::uint64_t count(const char* name, std::uint64_t limit) const {
    const auto value = xml::unsigned_number(attribute(name));
    if (!value || *value > limit) fail(fmt::format("{} is not a count up to {}", name, limit));
    return *value;
  }
  [[nodiscard]] std::uint32_t seq() const {
    return static_cast<std::uint32_t>(count("Seq", std::numeric_limits<std::uint32_t>::max()));
  }
  [[nodiscard]] std::uint64_t time_ms() const { return count("T", std::numeric_limits<std::uint64_t>::max()); }
  [[nodiscard]] bool flag(const char* name) const { return count(name, 1) == 1; }
  [[nodiscard]] std::string attribute(const char* name) const {
    const pugi::xml_attribute found = root().attribute(name);
    if (!found) fail(fmt::format("{} is missing", name));
    return found.value();
  }

  template <std::size_t kCount>
  void values(const char* element, const std::array<std::string_view, kCount>& names,
              std::array<double, kCount>& values) const {
    const pugi::xml_node found = root().child(element);
    if (!found || found.next_sibling(element)) fail(fmt::format("<{}> does not occur once", element));
    const std::string_view wrong = xml::read_attributes(found, names, values);
    if (!wrong.empty()) fail(fmt::format("<{}>: {} is missing or not a finite number", element, wrong));
  }

  [[noreturn]] void fail(const std::string& problem) const {
    throw WireError(fmt::format("document \"{}\": {}", wire::printable(text_), problem));
  }

 private:
  std::string_view text_;
  xml::Document document_;
};

template <std::size_t kCount>
void append_values(std::string& text, const std::array<std::string_view, kCount>& names,
                   const std::array<double, kCount>& values) {
  for (std::size_t k = 0; k < kCount; ++k) {
    text.append(" ").append(names[k]).append("=\"");
    if (!xml::append_decimal(text, values[k], kDecimals))
      throw WireError(fmt::format("{} {} cannot be encoded", names[k], values[k]));
    text += '"';
  }
}

constexpr std::array<std::string_view, 7> kAllAxisNames{"A1", "A2", "A3", "A4", "A5", "A6", "E1"};

State decode_state(const Reader& reader) {
  State state{reader.seq(),         reader.time_ms(),       reader.flag("DrivesPowered"), reader.flag("EmergencyStop"),
              reader.flag("RsiOn"), reader.flag("Stopped"), reader.attribute("Message")};
  if (state.message.size() > kMaxMessageCharacters)
    reader.fail(fmt::format("Message of more than {} characters", kMaxMessageCharacters));
  for (const char c : state.message)
    if (c < 0x20) reader.fail("Message has control characters");
  return state;
}

RobotState decode_robot_state(const Reader& reader) {
  RobotState state;
  state.seq = reader.seq();
  state.time_ms = reader.time_ms();
  reader.values("Pos", xml::kCartesianNames, state.cartesian);
  std::array<double, 7> axes{};
  reader.values("Axis", kAllAxisNames, axes);
  for (std::size_t k = 0; k < state.axes_deg.size(); ++k) state.axes_deg[k] = axes[k];
  state.track_mm = axes[6];
  return state;
}

}  // namespace

std::string_view name_of(Action action) {
  for (const ActionName& known : kActions)
    if (known.action == action) return known.name;
  return "";
}

std::string encode(const Command& command) {
  return fmt::format("<Command Seq=\"{}\" Do=\"{}\"/>", command.seq, name_of(command.action));
}

std::string encode(const State& state) {
  std::string text = fmt::format(
      "<State Seq=\"{}\" T=\"{}\" DrivesPowered=\"{:d}\" EmergencyStop=\"{:d}\" RsiOn=\"{:d}\" Stopped=\"{:d}\" "
      "Message=\"",
      state.seq, state.time_ms, state.drives_powered, state.emergency_stop, state.rsi_on, state.stopped);
  xml::append_escaped(text, std::string_view(state.message).substr(0, kMaxMessageCharacters));
  return text + "\"/>";
}

std::string encode(const RobotState& state) {
  std::string text = fmt::format("<RobotState Seq=\"{}\" T=\"{}\"><Pos", state.seq, state.time_ms);
  append_values(text, xml::kCartesianNames, state.cartesian);
  text += "/><Axis";
  std::array<double, 7> axes{};
  for (std::size_t k = 0; k < state.axes_deg.size(); ++k) axes[k] = state.axes_deg[k];
  axes[6] = state.track_mm;
  append_values(text, kAllAxisNames, axes);
  return text + "/></RobotState>";
}

Command decode_command(std::string_view document) {
  const Reader reader(document);
  if (std::string_view(reader.root().name()) != "Command") reader.fail("the root element is not <Command>");
  const std::string action = reader.attribute("Do");
  for (const ActionName& known : kActions)
    if (known.name == action) return {reader.seq(), known.action};
  reader.fail("Do is not status, start, stop, reset or pose");
}

Reply decode_reply(std::string_view document) {
  const Reader reader(document);
  const std::string_view root = reader.root().name();
  if (root == "State") return decode_state(reader);
  if (root == "RobotState") return decode_robot_state(reader);
  reader.fail("the root element is not <State> or <RobotState>");
}

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
