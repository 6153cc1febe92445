#pragma once
// Format of a generator without a public interface document: its datagrams and control lines are described in the
// mission file. Both ends use the same description.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "hil_drivers/grand/wire/bytes.h"
#include "hil_drivers/grand/wire/text_pattern.h"
#include "hil_drivers/grand/wire/trajectory_sample.h"
#include "host_sim/mission/table_reader.h"

namespace vbar::grand::wire {

enum class FieldType { kU8, kI8, kU16, kI16, kU32, kI32, kU64, kI64, kF32, kF64 };
/// Identification of the vehicle of a datagram: by a field of the datagram, or by the port to which it is sent.
enum class VehicleBy { kField, kPort };

// Names in mission files.
inline constexpr std::array<std::pair<std::string_view, FieldType>, 10> kFieldTypes = {{{"u8", FieldType::kU8},
                                                                                        {"i8", FieldType::kI8},
                                                                                        {"u16", FieldType::kU16},
                                                                                        {"i16", FieldType::kI16},
                                                                                        {"u32", FieldType::kU32},
                                                                                        {"i32", FieldType::kI32},
                                                                                        {"u64", FieldType::kU64},
                                                                                        {"i64", FieldType::kI64},
                                                                                        {"f32", FieldType::kF32},
                                                                                        {"f64", FieldType::kF64}}};
inline constexpr std::array<std::pair<std::string_view, ByteOrder>, 2> kByteOrders = {
    {{"little", ByteOrder::kLsbFirst}, {"big", ByteOrder::kMsbFirst}}};
inline constexpr std::array<std::pair<std::string_view, VehicleBy>, 2> kVehicleBys = {
    {{"field", VehicleBy::kField}, {"port", VehicleBy::kPort}}};

/// Field of a binary datagram.
struct TemplateField {
  std::string value = {};  ///< one of template_values(); empty: the constant
  double constant = 0.0;
  FieldType type = FieldType::kF64;
  double scale = 1.0;  ///< on the wire: value * scale, rounded for integer types
};

struct TemplateFormat {
  std::vector<TemplateField> fields = {};  ///< fields of the binary datagram, if `text` is empty
  ByteOrder byte_order = ByteOrder::kLsbFirst;
  std::string text = {};  ///< pattern of an ASCII datagram: "{time_s:.3f},{position_ecef_x:.4f}\n"
  VehicleBy vehicle_by = VehicleBy::kField;
  // Patterns of control lines over TCP, without line end; each is answered by one line. Places: control_values().
  std::vector<std::string> prepare_lines = {};
  std::vector<std::string> start_lines = {};
  std::vector<std::string> stop_lines = {};
  std::string accepted_answer = "OK";        ///< beginning of the answer to an accepted line
  std::string progress_line = {};            ///< question how far {vehicle} has been moved; empty: it cannot be asked
  std::string progress_answer = "{time_s}";  ///< pattern of the answer
};

/// Names of the values of a datagram: vehicle (from 1), time_s, time_ms, position_ecef_x, ...
[[nodiscard]] const std::vector<std::string_view>& template_values();
/// Names of the values of control lines: vehicle, vehicles, year, month, day, hour, minute, second, gps_week,
/// gps_tow_s, time_s.
[[nodiscard]] const std::vector<std::string_view>& control_values();
/// Returns the values of control lines for a start time.
[[nodiscard]] NamedValues control_values_of(fsw::GpsTime start, std::size_t vehicles);
/// Returns the start time that a line states, by date or by week; empty if it states none. Throws WireError.
[[nodiscard]] std::optional<fsw::GpsTime> start_time_of(const NamedValues& values);

/// Codec of a format that has been checked and prepared.
class TemplateCodec {
 public:
  /// Prepares the format. Throws WireError, one sentence: an unknown name with the list of the known ones, a format
  /// without time, position or vehicle, a pattern that cannot be read back.
  explicit TemplateCodec(TemplateFormat format);

  [[nodiscard]] const TemplateFormat& format() const { return format_; }

  /// Encodes a sample; `vehicle` counts from 0. Throws WireError for a sample that is not finite or does not fit into
  /// its type.
  [[nodiscard]] Bytes encode(std::size_t vehicle, const TrajectorySample& sample) const;

  struct Received {
    std::optional<std::size_t> vehicle = std::nullopt;  ///< from 0, if the datagram carries it
    TrajectorySample sample = {};                       ///< values that it does not carry are zero
  };
  /// Decodes a datagram. Throws WireError.
  [[nodiscard]] Received decode(std::span<const std::uint8_t> datagram) const;

  [[nodiscard]] const std::vector<TextPattern>& prepare_lines() const { return prepare_; }
  [[nodiscard]] const std::vector<TextPattern>& start_lines() const { return start_; }
  [[nodiscard]] const std::vector<TextPattern>& stop_lines() const { return stop_; }
  /// Pattern of the question for progress; empty if progress cannot be asked.
  [[nodiscard]] const std::optional<TextPattern>& progress_line() const { return progress_; }
  [[nodiscard]] const TextPattern& progress_answer() const { return progress_answer_; }

 private:
  [[nodiscard]] NamedValues decode_fields(std::span<const std::uint8_t> datagram) const;

  TemplateFormat format_;
  std::optional<TextPattern> text_;
  std::vector<TextPattern> prepare_, start_, stop_;
  std::optional<TextPattern> progress_;
  TextPattern progress_answer_;
};

// The description of a template in a table of a mission, or of a scenario of the bench:
//   fields = [ { value = "time_s", type = "f64", scale = 1.0 }, { constant = 1, type = "u32" }, ... ] and byte_order,
//   or text = "{time_s:.3f},..."; vehicle = "field" | "port"; prepare_lines, start_lines, stop_lines, accepted_answer,
//   progress_line, progress_answer.

/// Reads the description. Other keys of the table are left unread; the caller finishes it. Throws MissionError.
TemplateFormat read_template_format(const mission::TableReader& section);

}  // namespace vbar::grand::wire
