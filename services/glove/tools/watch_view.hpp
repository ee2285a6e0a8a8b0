#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>

#include "common/base/time.hpp"
#include "idl/Glove.h"
#include "idl/Operation.h"

namespace prehend::glove {

/// What the topics say of one glove, as a page of text or a JSON document. Pure: messages come in
/// with the time at which they were received.
class WatchView {
 public:
  explicit WatchView(std::string glove) : glove_(std::move(glove)) {}

  void hear(const v1::GloveFrame& frame, Time now);
  void hear(const v1::HandPosture& posture, Time now);
  /// Of any service; those that are no glove are left out.
  void hear(const v1::ServiceStatus& status);
  void lost_service(const std::string& key);

  bool heard_something() const { return frame_ || posture_ || !services_.empty(); }
  /// Lines of at most 80 characters.
  std::string page(Time now) const;
  std::string json(Time now) const;

 private:
  /// Times of the last two seconds.
  class Pace {
   public:
    void add(Time now);
    double rate(Time now) const;  // Hz

   private:
    std::deque<Time> times_;
  };

  std::string glove_;
  std::optional<v1::GloveFrame> frame_;
  std::optional<v1::HandPosture> posture_;
  Time frame_at_{}, posture_at_{};
  Pace frames_, postures_;
  std::deque<double> latency_ms_;  // of the last 256 postures: received - origin
  std::map<std::string, v1::ServiceStatus> services_;
};

}  // namespace prehend::glove
