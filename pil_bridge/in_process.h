#pragma once
// The flight software in this process, called through its C interface. The order of its inputs, and the handling of
// its output, follow boards/common/flight_executive.cpp, so that the result is the same as on a board.

#include <cstdint>
#include <memory>

#include "pil_bridge/flight_computer.h"
#include "pil_bridge/test_article.h"

namespace vbar::pil {

/// Throws FlightComputerError if the article refuses to start.
std::unique_ptr<FlightComputer> make_in_process(std::shared_ptr<const TestArticle> article, std::uint8_t spacecraft);

}  // namespace vbar::pil
