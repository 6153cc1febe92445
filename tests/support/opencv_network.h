#pragma once
// The keypoint network put together of OpenCV's layers, from a weights file.

#include <cstring>
#include <span>
#include <string>

#include <opencv2/core.hpp>
#include <opencv2/dnn.hpp>

#include "fsw/vision/pose/architecture.h"

namespace vbar::test {

class OpencvNetwork {
 public:
  explicit OpencvNetwork(std::span<const std::byte> file) : file_(file) {
    int last = 0;  // OpenCV's number of the input
    for (int l = 0; l < 3; ++l) last = add_layer(l, last);
    const int kept_32 = last;
    for (int l = 3; l < 5; ++l) last = add_layer(l, last);
    const int kept_16 = last;
    for (int l = 5; l < 9; ++l) last = add_layer(l, last);
    last = add_layer(9, add_sum("sum_16", enlarge("enlarged_16", last), kept_16));
    last = add_layer(10, last);
    last = add_layer(11, add_sum("sum_32", enlarge("enlarged_32", last), kept_32));
    add_layer(12, last);
    net_.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
    net_.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
  }

  /// 1 x channels x rows x columns.
  cv::Mat run(std::span<const float, fsw::pose::kInputSamples> crop) {
    const int shape[] = {1, 1, fsw::pose::kInputSide, fsw::pose::kInputSide};
    cv::Mat input(4, shape, CV_32F);
    std::memcpy(input.data, crop.data(), crop.size_bytes());
    net_.setInput(input);
    return net_.forward();
  }

 private:
  /// OpenCV wants [out][in][row][column].
  [[nodiscard]] cv::Mat weights_of(int l) const {
    const fsw::pose::Layer& layer = fsw::pose::kLayers[static_cast<std::size_t>(l)];
    const int shape[] = {layer.out, layer.in, layer.kernel, layer.kernel};
    cv::Mat weights(4, shape, CV_32F);
    const std::byte* from = file_.data() + fsw::pose::offset_of_layer(l);
    for (int row = 0; row < layer.kernel; ++row) {
      for (int column = 0; column < layer.kernel; ++column) {
        for (int in = 0; in < layer.in; ++in) {
          for (int out = 0; out < layer.out; ++out, from += sizeof(float)) {
            const int place[] = {out, in, row, column};
            std::memcpy(weights.ptr(place), from, sizeof(float));
          }
        }
      }
    }
    return weights;
  }

  [[nodiscard]] cv::Mat biases_of(int l) const {
    const fsw::pose::Layer& layer = fsw::pose::kLayers[static_cast<std::size_t>(l)];
    cv::Mat biases(1, layer.out, CV_32F);
    std::memcpy(biases.data, file_.data() + fsw::pose::offset_of_layer(l) + sizeof(float) * layer.weights(),
                sizeof(float) * static_cast<std::size_t>(layer.out));
    return biases;
  }

  int add_layer(int l, int input) {
    const fsw::pose::Layer& layer = fsw::pose::kLayers[static_cast<std::size_t>(l)];
    cv::dnn::LayerParams params;
    params.set("kernel_size", layer.kernel);
    params.set("stride", layer.stride);
    params.set("pad", layer.kernel / 2);
    params.set("num_output", layer.out);
    params.set("bias_term", true);
    params.blobs = {weights_of(l), biases_of(l)};
    const int convolution = add("convolution" + std::to_string(l), "Convolution", params, input);
    if (!layer.is_rectified) return convolution;
    cv::dnn::LayerParams none;
    return add("rectifier" + std::to_string(l), "ReLU", none, convolution);
  }

  int enlarge(const std::string& name, int input) {
    cv::dnn::LayerParams params;
    params.set("zoom_factor", 2);
    params.set("interpolation", "nearest");
    return add(name, "Resize", params, input);
  }

  int add_sum(const std::string& name, int a, int b) {
    cv::dnn::LayerParams params;
    params.set("operation", "sum");
    const int id = add(name, "Eltwise", params, a);
    net_.connect(b, 0, id, 1);
    return id;
  }

  int add(const std::string& name, const std::string& type, cv::dnn::LayerParams& params, int input) {
    const int id = net_.addLayer(name, type, params);
    net_.connect(input, 0, id, 0);
    return id;
  }

  std::span<const std::byte> file_;
  cv::dnn::Net net_;
};

}  // namespace vbar::test
