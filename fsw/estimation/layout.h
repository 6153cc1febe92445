#pragma once
// Position of each block in the state of a filter. A mission composes its state from blocks - orbit, clocks, attitude,
// ambiguities - by naming them in a list; blocks have a size and are independent of each other.
//
//   using State = Layout<RelativeOrbit, EmpiricalAcceleration, ReceiverClock>;
//   State::kSize, State::offset<ReceiverClock>()

#include <type_traits>

namespace vbar::fsw::estimation {

/// Blocks have `static constexpr int kSize`. The same block twice: wrap it (struct TargetClock : ReceiverClock {}).
template <class... Blocks>
struct Layout {
  static constexpr int kSize = (Blocks::kSize + ... + 0);

  /// Index of the block's first component.
  template <class Block>
  static constexpr int offset() {
    static_assert((std::is_same_v<Block, Blocks> + ... + 0) == 1, "the block is not in the layout, or twice");
    int sum = 0;
    bool found = false;
    ((found = found || std::is_same_v<Block, Blocks>, sum += found ? 0 : Blocks::kSize), ...);
    return sum;
  }

  /// Calls visit.operator()<Block>() for each block, in order.
  template <class Visitor>
  static constexpr void for_each(Visitor&& visit) {
    (visit.template operator()<Blocks>(), ...);
  }
};

template <class First, class Second>
struct Joined;
template <class... First, class... Second>
struct Joined<Layout<First...>, Layout<Second...>> {
  using Type = Layout<First..., Second...>;
};
/// The blocks of both layouts, those of the first before those of the second.
template <class First, class Second>
using JoinedLayout = typename Joined<First, Second>::Type;

}  // namespace vbar::fsw::estimation
