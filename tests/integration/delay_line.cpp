// prehend-delay-line PID DEVICE PID DEVICE DELAY_MS JITTER_MS
// A long cable between two network spaces, given by a process in each: makes a TAP device in both
// and holds every frame back on its way from one to the other, each for a delay of its own, in
// order, as a queue in a router would. Runs until it is killed.
#include <fcntl.h>
#include <linux/if.h>
#include <linux/if_tun.h>
#include <poll.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <random>
#include <string>
#include <vector>

namespace {

using Clock = std::chrono::steady_clock;

int tap_in(const std::string& pid, const std::string& device) {
  const int space = ::open(("/proc/" + pid + "/ns/net").c_str(), O_RDONLY);
  if (space < 0 || ::setns(space, CLONE_NEWNET) != 0) return -1;
  ::close(space);
  const int tap = ::open("/dev/net/tun", O_RDWR | O_NONBLOCK);
  ifreq request{};
  request.ifr_flags = IFF_TAP | IFF_NO_PI;
  std::strncpy(request.ifr_name, device.c_str(), IFNAMSIZ - 1);
  return tap >= 0 && ::ioctl(tap, TUNSETIFF, &request) == 0 ? tap : -1;
}

struct Held {
  Clock::time_point due;
  std::vector<char> frame;
};

struct Way {
  int from, to;
  std::deque<Held> queue;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 7) {
    std::fprintf(stderr, "usage: prehend-delay-line PID DEVICE PID DEVICE DELAY_MS JITTER_MS\n");
    return 2;
  }
  const int one = tap_in(argv[1], argv[2]), other = tap_in(argv[3], argv[4]);
  if (one < 0 || other < 0) {
    std::perror("prehend-delay-line");
    return 3;
  }
  const double delay = std::atof(argv[5]), jitter = std::atof(argv[6]);
  std::mt19937 random{1};
  std::uniform_real_distribution<double> spread(std::max(0.0, delay - jitter), delay + jitter);
  std::array<Way, 2> ways{Way{one, other, {}}, Way{other, one, {}}};
  std::vector<char> buffer(65536);
  while (true) {
    auto wake = Clock::now() + std::chrono::seconds(1);
    for (const Way& way : ways)
      if (!way.queue.empty()) wake = std::min(wake, way.queue.front().due);
    std::array<pollfd, 2> polled{pollfd{one, POLLIN, 0}, pollfd{other, POLLIN, 0}};
    const auto left = std::max(Clock::duration::zero(), wake - Clock::now());
    const timespec timeout{left / std::chrono::seconds(1),
                           (left % std::chrono::seconds(1)) / std::chrono::nanoseconds(1)};
    ::ppoll(polled.data(), polled.size(), &timeout, nullptr);
    for (Way& way : ways) {
      for (ssize_t n; (n = ::read(way.from, buffer.data(), buffer.size())) > 0;) {
        auto due = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                      std::chrono::duration<double, std::milli>(spread(random)));
        if (!way.queue.empty()) due = std::max(due, way.queue.back().due);
        way.queue.push_back({due, {buffer.begin(), buffer.begin() + n}});
      }
      for (; !way.queue.empty() && way.queue.front().due <= Clock::now(); way.queue.pop_front()) {
        const auto& frame = way.queue.front().frame;
        if (::write(way.to, frame.data(), frame.size()) < 0) continue;  // the device is down
      }
    }
  }
}
