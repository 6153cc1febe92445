#include <algorithm>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hil_drivers/grand/pps/kernel_edges.h"
#include "hil_drivers/grand/pps/socket_edges.h"
#include "hil_drivers/grand/pps/timer_edges.h"

namespace vbar::grand {
namespace {

constexpr const EdgeSourceKind* kEdgeSourceKinds[] = {&kKernelEdges, &kSocketEdges, &kTimerEdges};

std::string_view device_of(std::string_view text) {
  const std::size_t colon = text.find(':');
  return colon == std::string_view::npos ? std::string_view() : text.substr(colon + 1);
}

}  // namespace

std::span<const EdgeSourceKind* const> edge_source_kinds() {
  return kEdgeSourceKinds;
}

const EdgeSourceKind* find_edge_source(std::string_view text) {
  const std::string_view name = text.substr(0, text.find(':'));
  const auto found =
      std::ranges::find_if(kEdgeSourceKinds, [&](const EdgeSourceKind* kind) { return kind->name == name; });
  if (found == std::end(kEdgeSourceKinds)) return nullptr;
  return (*found)->has_device == !device_of(text).empty() ? *found : nullptr;
}

std::unique_ptr<EdgeSource> make_edge_source(std::string_view text) {
  const EdgeSourceKind* const kind = find_edge_source(text);
  if (kind == nullptr)
    throw std::runtime_error(
        fmt::format("\"{}\" is not a source of PPS edges; accepted: {}", text, edge_source_forms()));
  return kind->make(std::string(device_of(text)));
}

std::string edge_source_forms() {
  std::vector<std::string> forms;
  for (const EdgeSourceKind* const kind : kEdgeSourceKinds) forms.push_back(fmt::format("\"{}\"", kind->form));
  return fmt::format("{}", fmt::join(forms, ", "));
}

}  // namespace vbar::grand
