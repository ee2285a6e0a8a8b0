#pragma once

#include <mutex>
#include <set>

namespace prehend::dds {

/// All objects of a kind that this process has, for a thread that looks at each of them.
template <class T>
class Registry {
 public:
  /// The one of this kind. It outlives the threads that look.
  static Registry& of_process() {
    static auto* instance = new Registry;
    return *instance;
  }
  void add(const T& one) {
    const std::scoped_lock lock(mutex_);
    all_.insert(&one);
  }
  void remove(const T& one) {
    const std::scoped_lock lock(mutex_);
    all_.erase(&one);
  }
  /// None comes or goes meanwhile.
  template <class Visit>
  void for_each(const Visit& visit) const {
    const std::scoped_lock lock(mutex_);
    for (const T* one : all_) visit(*one);
  }

 private:
  mutable std::mutex mutex_;
  std::set<const T*> all_;
};

}  // namespace prehend::dds
