#include "hil_drivers/tron/eki/wire/documents.h"

#include <limits>

#include <fmt/format.h>

#include "hil_drivers/tron/xml/document.h"

namespace vbar::tron::eki {
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

}  // namespace vbar::tron::eki
