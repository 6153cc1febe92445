#include "host_sim/twins/camera/worker.h"

namespace vbar::twins::camera {

Worker::Worker() : thread_([this] { work(); }) {}

Worker::~Worker() {
  stop();
}

void Worker::stop() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
    jobs_.clear();
  }
  something_to_do_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void Worker::enqueue(std::function<void()> job) {
  {
    const std::lock_guard lock(mutex_);
    if (stop_) return;
    jobs_.push_back(std::move(job));
  }
  something_to_do_.notify_one();
}

void Worker::work() {
  while (true) {
    std::function<void()> job;
    {
      std::unique_lock lock(mutex_);
      something_to_do_.wait(lock, [this] { return stop_ || !jobs_.empty(); });
      if (stop_) return;
      job = std::move(jobs_.front());
      jobs_.pop_front();
    }
    job();
  }
}

}  // namespace vbar::twins::camera
