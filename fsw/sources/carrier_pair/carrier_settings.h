#pragma once
// The telecommand of carrier phase, validated and converted to settings.

#include "fsw/core/result.h"
#include "fsw/estimation/gauss_markov.h"
#include "fsw/packets/messages.h"
#include "fsw/sources/carrier_pair/carrier_aiding.h"

namespace vbar::fsw::sources {

[[nodiscard]] bool is_valid(const carrier_configuration& configuration);

/// kOutOfRange for an invalid telecommand.
Result<CarrierSettings> carrier_settings(const carrier_configuration& configuration,
                                         const receiver_configuration& receiver);
/// Returns the wander of a single difference, hence of two independent channels.
[[nodiscard]] estimation::GaussMarkov phase_wander_of(const carrier_configuration& configuration);

}  // namespace vbar::fsw::sources
