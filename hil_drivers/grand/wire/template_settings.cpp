#include "hil_drivers/grand/wire/template_settings.h"

#include "host_sim/mission/mission_error.h"

namespace vbar::grand::wire {
namespace {

TemplateField read_field(const mission::TableReader& section) {
  constexpr double kLargest = 1e300;
  TemplateField field;
  const bool has_constant = section.has("constant");
  if (has_constant == section.has("value"))
    section.refuse("", has_constant ? "both value and constant" : "neither value nor constant",
                   "one of them in each field");
  if (has_constant) {
    field.constant = section.number("constant", mission::from_to(-kLargest, kLargest));
  } else {
    field.value = section.choice("value", template_values(), "");
    field.scale = section.number("scale", mission::from_to(-kLargest, kLargest), 1.0);
  }
  field.type = section.choice("type", kFieldTypes);
  section.finish();
  return field;
}

}  // namespace

TemplateFormat read_template_format(const mission::TableReader& section) {
  TemplateFormat format;
  for (const mission::TableReader& field : section.tables("fields")) format.fields.push_back(read_field(field));
  format.byte_order = section.choice("byte_order", kByteOrders, std::optional(format.byte_order));
  format.text = section.text("text", format.text);
  format.vehicle_by = section.choice("vehicle", kVehicleBys, std::optional(format.vehicle_by));
  format.prepare_lines = section.texts("prepare_lines");
  format.start_lines = section.texts("start_lines");
  format.stop_lines = section.texts("stop_lines");
  format.accepted_answer = section.text("accepted_answer", format.accepted_answer);
  format.progress_line = section.text("progress_line", format.progress_line);
  format.progress_answer = section.text("progress_answer", format.progress_answer);
  try {
    static_cast<void>(TemplateCodec(format));
  } catch (const WireError& error) {
    section.refuse("", error.what(), "a description that both writes and reads datagrams and lines");
  }
  return format;
}

}  // namespace vbar::grand::wire
