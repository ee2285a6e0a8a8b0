#pragma once

#include <mutex>
#include <string>
#include <thread>

#include "services/recognition/core/picture/picture.hpp"

namespace prehend::integration {

/// A network camera: sends what stands before it as motion jpeg over HTTP, with fresh noise in
/// every picture, to one guest at a time. May be switched off and on again at the same address.
class StreamCamera {
 public:
  explicit StreamCamera(double rate);
  ~StreamCamera();

  std::string address() const { return "http://127.0.0.1:" + std::to_string(port_) + "/video"; }
  /// From now on this, before the sensor's noise.
  void show(recognition::Picture still);
  /// Hangs up, and answers nobody.
  void off();
  void on();

 private:
  void serve(const std::stop_token& stop);
  bool send(int guest, const recognition::Picture& picture) const;

  double period_;  // s
  int port_ = 0, socket_ = -1;
  std::mutex mutex_;
  recognition::Picture still_;
  std::jthread thread_;
};

}  // namespace prehend::integration
