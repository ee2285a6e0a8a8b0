#include "services/glove/devices/persistent.hpp"

#include <condition_variable>
#include <mutex>

#include "common/serial/overheard.hpp"

namespace prehend::glove {

void Persistent::start(Life life, std::function<void(std::string)> complain) {
  thread_ = std::jthread(
      [this, life = std::move(life), complain = std::move(complain)](const std::stop_token& stop) {
        while (!stop.stop_requested()) {
          const auto done = life(stop);
          if (done) continue;
          std::string line = done.error().message();
          if (serial::is_news(line, said_)) {
            complain(line);
            said_ = std::move(line);
          }
          pause(stop, std::chrono::milliseconds(200));
        }
      });
}

void Persistent::pause(const std::stop_token& stop, Duration duration) {
  std::mutex mutex;
  std::condition_variable_any wake;
  std::unique_lock lock(mutex);
  wake.wait_for(lock, stop, duration, [] { return false; });
}

}  // namespace prehend::glove
