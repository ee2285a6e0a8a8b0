#include "common/service/task_queue.hpp"

#include <utility>

namespace prehend::service {

void TaskQueue::post(std::function<void()> task) {
  {
    const std::scoped_lock lock(mutex_);
    tasks_.push_back(std::move(task));
    woken_ = true;
  }
  condition_.notify_one();
}

void TaskQueue::wake() {
  {
    const std::scoped_lock lock(mutex_);
    woken_ = true;
  }
  condition_.notify_one();
}

void TaskQueue::run() {
  std::deque<std::function<void()>> tasks;
  {
    const std::scoped_lock lock(mutex_);
    tasks.swap(tasks_);
  }
  for (auto& task : tasks) task();
}

void TaskQueue::wait(Duration limit) {
  std::unique_lock lock(mutex_);
  condition_.wait_for(lock, limit, [this] { return woken_; });
  woken_ = false;
}

}  // namespace prehend::service
