#pragma once
// Errors as values. A function that can fail returns Result<T>; a caller cannot ignore it silently.

#include <cstdint>

namespace vbar::fsw {

/// Reason why an operation was rejected or failed. One list serves all flight code, so that telemetry can carry it.
enum class Status : std::uint8_t {
  kOk = 0,
  kInvalidArgument,  ///< a precondition of the call does not hold
  kNotFinite,        ///< a NaN or an infinity where a finite value is required
  kOutOfRange,       ///< a number outside the range in which the model or the table is valid
  kDidNotConverge,   ///< an iteration reached its bound
  kSingular,         ///< a linear system without a usable solution
  kFull,             ///< a queue, pool or buffer has no room left
  kTooShort,         ///< input ends before the item it should contain
  kTooLong,          ///< input is longer than the item it should contain
  kWrongType,        ///< packet identifier or type hash is not the expected one
  kBadChecksum,      ///< CRC does not match
  kBadSequence,      ///< out of order, duplicated or of another session
  kUnsafe,           ///< a plan that fails the passive-safety test
  kNotReady,         ///< requested before it is available
};

/// A value or the reason why it is missing. `value()` may only be read when `ok()`.
template <class T>
class [[nodiscard]] Result {
 public:
  constexpr Result(const T& value) : value_(value), status_(Status::kOk) {}  // NOLINT: implicit on purpose
  constexpr Result(Status error) : value_{}, status_(error) {}               // NOLINT: implicit on purpose

  [[nodiscard]] constexpr bool ok() const { return status_ == Status::kOk; }
  [[nodiscard]] constexpr Status status() const { return status_; }
  [[nodiscard]] constexpr const T& value() const { return value_; }

 private:
  T value_;
  Status status_;
};

}  // namespace vbar::fsw
