#pragma once
// The description of a template in a table of a mission, or of a scenario of the bench:
//   fields = [ { value = "time_s", type = "f64", scale = 1.0 }, { constant = 1, type = "u32" }, ... ] and byte_order,
//   or text = "{time_s:.3f},..."; vehicle = "field" | "port"; prepare_lines, start_lines, stop_lines, accepted_answer,
//   progress_line, progress_answer.

#include "hil_drivers/grand/wire/template_format.h"
#include "host_sim/mission/table_reader.h"

namespace vbar::grand::wire {

/// Reads the description. Other keys of the table are left unread; the caller finishes it. Throws MissionError.
TemplateFormat read_template_format(const mission::TableReader& section);

}  // namespace vbar::grand::wire
