#pragma once
// Cooperative second thread: it works only while the first one waits for it. A function that has to wait for simulated
// time is continued at each call. Both together are deterministic, as one thread would be.

#include <atomic>
#include <functional>
#include <future>
#include <semaphore>

#include "host_sim/io/byte_channel.h"

namespace vbar::grand {

class Turns {
 public:
  using Point = io::Clock::time_point;

  Turns() = default;
  ~Turns() { abandon(); }
  Turns(const Turns&) = delete;
  Turns& operator=(const Turns&) = delete;

  /// Starts the work. `work` calls wait() to be continued later; it must return or throw soon after is_abandoned().
  void start(std::function<void()> work) {
    is_done_ = false;
    work_ = std::async(std::launch::async, [this, run = std::move(work)] {
      to_work_.acquire();
      struct End {
        Turns& turns;
        ~End() {
          turns.is_done_ = true;
          turns.to_caller_.release();
        }
      } end{*this};
      run();
    });
  }
  [[nodiscard]] bool is_running() const { return work_.valid(); }

  /// Continues the work at `time`, until it waits or ends. Returns true if it has ended; throws what it has thrown.
  bool go_on(Point time) {
    time_ = time;
    to_work_.release();
    to_caller_.acquire();
    if (!is_done_) return false;
    work_.get();
    return true;
  }

  /// Ends the work.
  void abandon() noexcept {
    is_abandoned_ = true;
    while (work_.valid()) {
      try {
        go_on(time_);
      } catch (...) {
        // The work ends by its own exception.
      }
    }
  }

  // Calls of the work.
  [[nodiscard]] Point now() const { return time_; }
  void wait() {
    to_caller_.release();
    to_work_.acquire();
  }
  [[nodiscard]] bool is_abandoned() const { return is_abandoned_; }

 private:
  std::binary_semaphore to_work_{0}, to_caller_{0};
  std::future<void> work_;
  Point time_{};
  bool is_done_ = false;
  std::atomic<bool> is_abandoned_ = false;
};

}  // namespace vbar::grand
