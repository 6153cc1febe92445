#pragma once
// Memory of one run of the network: 1.1 MB, each store used by layers of one shape, so that borders stay 0.

#include "fsw/vision/pose/convolution.h"
#include "fsw/vision/pose/feature_map.h"

namespace vbar::fsw::pose {

struct Activations {
  FeatureStore<128, 1> input;
  FeatureStore<64, 24> stem;
  FeatureStore<32, 40> passing_32;  ///< output of the encoder, reused in the decoder
  FeatureStore<32, 40> kept_32;     ///< skip connection: of the encoder, until added in the decoder
  FeatureStore<16, 64> passing_16;
  FeatureStore<16, 64> kept_16;
  FeatureStore<8, 128> first_8;
  FeatureStore<8, 128> second_8;
  WeightPanel panel;
};

}  // namespace vbar::fsw::pose
