#pragma once
// A thread for work that must stay on one thread (an OpenGL context), in the order of the requests.

#include <condition_variable>
#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <thread>
#include <type_traits>
#include <utility>

namespace vbar::twins::camera {

class Worker {
 public:
  Worker();
  ~Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  /// Returns when the job at hand is finished; the futures of jobs not started are broken (std::future_error), as are
  /// those of jobs to come.
  void stop();

  /// Runs `job` on the worker's thread, after all jobs before it; its exceptions come out of the future.
  template <class Job>
  std::future<std::invoke_result_t<Job>> run(Job job) {
    // A std::function must be copyable, which a task is not.
    auto task = std::make_shared<std::packaged_task<std::invoke_result_t<Job>()>>(std::move(job));
    auto result = task->get_future();
    enqueue([task = std::move(task)] { (*task)(); });
    return result;
  }

 private:
  void enqueue(std::function<void()> job);
  void work();

  std::mutex mutex_;
  std::condition_variable something_to_do_;
  std::deque<std::function<void()>> jobs_;
  bool stop_ = false;
  std::thread thread_;  // last: it uses all the others
};

}  // namespace vbar::twins::camera
