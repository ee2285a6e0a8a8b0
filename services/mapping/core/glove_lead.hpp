#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "common/base/time.hpp"

namespace prehend::mapping {

/// Whose postures are answered: those of one glove, until nothing of it could be answered for a
/// while. Two would lead one hand in turns.
class GloveLead {
 public:
  /// The first bytes of a writer's identity: its participant.
  using Writer = std::array<std::uint8_t, 12>;

  bool admits(const Writer& writer, Time now) const {
    return !leader_ || *leader_ == writer || now - led_ > max_silence;
  }
  /// A posture has been answered.
  void followed(const Writer& writer, Time now) {
    if (leader_ != writer) second_.reset();
    leader_ = writer;
    led_ = now;
  }
  /// From now on this one leads, whoever led before.
  void take_over(const Writer& writer, Time now) { followed(writer, now); }
  void refused(const Writer& writer, Time now) {
    second_ = writer;
    refused_ = now;
  }

  const std::optional<Writer>& followed() const { return leader_; }
  /// Who else has sent postures not long ago.
  std::optional<Writer> second(Time now) const {
    return second_ && now - refused_ <= noticed ? second_ : std::nullopt;
  }

  static constexpr Duration max_silence = std::chrono::milliseconds(300);
  static constexpr Duration noticed = std::chrono::seconds(1);

 private:
  std::optional<Writer> leader_, second_;
  Time led_{}, refused_{};
};

}  // namespace prehend::mapping
