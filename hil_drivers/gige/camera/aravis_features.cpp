#include "hil_drivers/gige/camera/aravis_features.h"

#include <cmath>

#include <fmt/format.h>

namespace vbar::gige {
namespace {

template <class Value>
void require(const GlibError& error, const char* name, const Value& value) {
  if (error) throw FeatureError(fmt::format("{} = {} is refused: {}", name, value, error.text()));
}

template <class Value>
[[noreturn]] void fail_read_back(const char* name, const Value& set, const Value& found) {
  throw FeatureError(fmt::format("{} is set to {} and reads back as {}", name, set, found));
}

}  // namespace

const char* Features::find(Names names, Need need) const {
  for (const char* name : names) {
    GlibError error;
    const bool is_available = arv_device_is_feature_available(device_, name, error.out());
    if (error) throw FeatureError(fmt::format("{} cannot be read: {}", name, error.text()));
    if (is_available) return name;
  }
  if (need == Need::kRequired) throw FeatureError(fmt::format("the camera has no feature {}", *names.begin()));
  return nullptr;
}

void Features::set_text(Names names, const char* value, Need need) const {
  const char* const name = find(names, need);
  if (name == nullptr) return;
  GlibError error;
  arv_device_set_string_feature_value(device_, name, value, error.out());
  require(error, name, value);
  const std::string found = text(name);
  if (found != value) fail_read_back(name, std::string(value), found);
}

void Features::set_flag(Names names, bool value, Need need) const {
  const char* const name = find(names, need);
  if (name == nullptr) return;
  GlibError error;
  arv_device_set_boolean_feature_value(device_, name, value, error.out());
  require(error, name, value);
  const bool found = arv_device_get_boolean_feature_value(device_, name, error.out());
  require(error, name, value);
  if (found != value) fail_read_back(name, value, found);
}

void Features::set_integer(Names names, gint64 value, Need need) const {
  const char* const name = find(names, need);
  if (name == nullptr) return;
  GlibError error;
  arv_device_set_integer_feature_value(device_, name, value, error.out());
  require(error, name, value);
  const gint64 found = integer(name);
  if (found != value) fail_read_back(name, value, found);
}

void Features::set_number(Names names, double value, double tolerance, Need need) const {
  const char* const name = find(names, need);
  if (name == nullptr) return;
  GlibError error;
  arv_device_set_float_feature_value(device_, name, value, error.out());
  require(error, name, value);
  const double found = arv_device_get_float_feature_value(device_, name, error.out());
  require(error, name, value);
  if (!(std::abs(found - value) <= tolerance)) fail_read_back(name, value, found);
}

void Features::execute(const char* name) const {
  GlibError error;
  arv_device_execute_command(device_, name, error.out());
  if (error) throw FeatureError(fmt::format("{} is not executed: {}", name, error.text()));
}

gint64 Features::integer(const char* name) const {
  GlibError error;
  const gint64 value = arv_device_get_integer_feature_value(device_, name, error.out());
  if (error) throw FeatureError(fmt::format("{} cannot be read: {}", name, error.text()));
  return value;
}

std::string Features::text(const char* name) const {
  GlibError error;
  const char* const value = arv_device_get_string_feature_value(device_, name, error.out());
  if (error || value == nullptr) throw FeatureError(fmt::format("{} cannot be read: {}", name, error.text()));
  return value;
}

std::optional<gint64> Features::integer_if_available(const char* name) const {
  if (find({name}, Need::kIfAvailable) == nullptr) return std::nullopt;
  return integer(name);
}

}  // namespace vbar::gige
