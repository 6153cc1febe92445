#pragma once
// Blocks of a state that carry their own process model: a filter propagates them by one loop over its list and depends
// on none of them. A block is a struct beside the measurement source that needs it:
//
//   static constexpr int kSize                                       number of its components
//   Settings, static constexpr Settings kDefaults                    optional: settings of its process
//   Adaptation                                                       optional: what its source adapts during a mission
//   propagate<State>(estimate, settings[, adaptation], step)         optional: its process; without it a constant
//   static constexpr bool kFollowsAttitude = true                    optional: deactivated with the target's attitude
//   initialize_with_attitude<State>(estimate, settings)              optional: initialised with that attitude
//   static constexpr bool kDeterminesOrbit = true                    optional: its source, while active, determines the
//                                                                    orbit far better than any image

#include <type_traits>

#include "fsw/estimation/estimate.h"

namespace vbar::fsw::estimation {

// Position of each block in the state of a filter. A mission composes its state from blocks - orbit, clocks, attitude,
// ambiguities - by naming them in a list; blocks have a size and are independent of each other.
//
//   using State = Layout<RelativeOrbit, EmpiricalAcceleration, ReceiverClock>;
//   State::kSize, State::offset<ReceiverClock>()

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

/// What a process may depend on beside its own components.
struct BlockStep {
  double dt_s = 0.0;
  double target_rate = 0.0;  ///< rad/s
};

template <class Block>
concept HasSettings = requires {
  typename Block::Settings;
};
template <class Block>
concept HasAdaptation = requires {
  typename Block::Adaptation;
};
template <class Block>
concept FollowsAttitude = requires {
  requires Block::kFollowsAttitude;
};
template <class Block, class State>
concept IsInitializedWithAttitude = requires(Estimate<State::kSize>& estimate,
                                             const typename Block::Settings& settings) {
  Block::template initialize_with_attitude<State>(estimate, settings);
};
template <class Block>
concept DeterminesOrbit = requires {
  requires Block::kDeterminesOrbit;
};

template <class Block>
struct SettingsOf {};
template <HasSettings Block>
struct SettingsOf<Block> {
  typename Block::Settings value = Block::kDefaults;
};

template <class Block>
struct AdaptationOf {};
template <HasAdaptation Block>
struct AdaptationOf<Block> {
  typename Block::Adaptation value;
};

/// Settings of all blocks of a layout, by the type of the block.
template <class List>
struct BlockSettings;
template <class... Blocks>
struct BlockSettings<Layout<Blocks...>> : SettingsOf<Blocks>... {
  template <HasSettings Block>
  [[nodiscard]] typename Block::Settings& of() {
    return SettingsOf<Block>::value;
  }
  template <HasSettings Block>
  [[nodiscard]] const typename Block::Settings& of() const {
    return SettingsOf<Block>::value;
  }
};

/// What the sources have adapted, by the type of the block.
template <class List>
struct BlockAdaptations;
template <class... Blocks>
struct BlockAdaptations<Layout<Blocks...>> : AdaptationOf<Blocks>... {
  template <HasAdaptation Block>
  [[nodiscard]] typename Block::Adaptation& of() {
    return AdaptationOf<Block>::value;
  }
  template <HasAdaptation Block>
  [[nodiscard]] const typename Block::Adaptation& of() const {
    return AdaptationOf<Block>::value;
  }
};

/// Propagates one block of the state; a block without a process model stays as it is.
template <class State, class Block, class Estimate, class List>
void propagate_block(Estimate& estimate, const BlockSettings<List>& settings, const BlockAdaptations<List>& adaptations,
                     const BlockStep& step) {
  if constexpr (HasAdaptation<Block>) {
    Block::template propagate<State>(estimate, settings.template of<Block>(), adaptations.template of<Block>(), step);
  } else if constexpr (HasSettings<Block>) {
    Block::template propagate<State>(estimate, settings.template of<Block>(), step);
  }
}

}  // namespace vbar::fsw::estimation
