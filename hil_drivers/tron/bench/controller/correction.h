#pragma once
// Conversion of the answers of the computer to commands of the axes: values that hold or fall to zero, silent clamping,
// and the overall monitor.

#include <string>

#include "hil_drivers/tron/bench/controller/servo.h"
#include "hil_drivers/tron/rsi/wire/context_xml.h"
#include "hil_drivers/tron/rsi/wire/ethernet_xml.h"

namespace vbar::tron::bench {

class Correction {
 public:
  Correction(const rsi::EthernetXml& ethernet, const rsi::ContextXml& context);

  /// Begins at RSI_ON: all values are zero, and count from `pose`.
  void begin(const AxisArray& pose);
  /// Sets the values of this cycle: those of the answer, or nullptr if there is no valid one.
  void take(const rsi::Sen* answer);

  [[nodiscard]] const AxisArray& command() const { return command_; }
  [[nodiscard]] bool was_clamped() const { return was_clamped_; }
  /// Returns true if Stop has changed from 0 to 1.
  [[nodiscard]] bool stop_rises() const { return stop_rises_; }
  /// Names the axis whose overall correction is beyond its monitor; empty: none is.
  [[nodiscard]] const std::string& beyond_monitor() const { return beyond_monitor_; }

 private:
  void take_value(std::size_t axis, const rsi::ReceivedValue& received, std::optional<double> value);
  void take_stop(const rsi::Sen* answer);
  void apply(std::size_t axis, const rsi::CorrectionRange& range, double monitor);

  rsi::EthernetXml ethernet_;
  rsi::ContextXml context_;
  AxisArray pose_{}, command_{}, values_{};  ///< values in deg and mm
  bool was_clamped_ = false, stop_ = false, stop_rises_ = false;
  std::string beyond_monitor_;
};

}  // namespace vbar::tron::bench
