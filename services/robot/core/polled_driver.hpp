#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "services/robot/core/driver.hpp"
#include "services/robot/core/silence.hpp"

namespace prehend::robot {

/// A driver of one device that speaks only when it is asked: a question, its answer, a pause, the
/// next question. Who does not answer, is answered for by another, or says that something is wrong,
/// is named, left alone for a while, and asked anew.
class PolledDriver : public Driver {
 public:
  struct Pace {
    Duration pause{};     // between an answer and the next question
    Duration patience{};  // for an answer
  };

  void connected(Time now) final;
  void disconnected(const std::string& why) final;
  std::string step(std::string_view heard, Time now) final;

 protected:
  enum class Heard {
    nothing,
    answer,
    refusal,  // it hears, and does not do what it is asked
    foreign   // another's, or one to another question
  };

  PolledDriver(const model::HandModel& hand, const DriverOptions& options, Pace pace)
      : hand_(hand), options_(options), pace_(pace) {}

  /// The conversation begins anew: what was known of the device may be so no more.
  virtual void begin(Time now) = 0;
  /// What is to be asked or told next; empty: nothing now.
  virtual std::string question(Time now) = 0;
  virtual void feed(std::string_view bytes) = 0;
  /// Takes in the next whole answer. What is none for us is counted; why it is none may be kept by
  /// suspect(), should nothing better come.
  virtual Heard hear(Time now) = 0;
  /// Forgets bytes that have become no answer.
  virtual void forget() = 0;
  /// What makes it stay where it is; empty: nothing moves, or it presses.
  virtual std::string stay() = 0;
  /// Of one that answers: what is wrong with how it moves.
  virtual std::optional<std::string> what_is_wrong() const = 0;

  void suspect(std::string why) { suspicion_ = std::move(why); }
  /// An answer of another device than the one that was asked is suspected and counted.
  bool is_of_another(int asked, int answered);

  const model::HandModel& hand_;
  DriverOptions options_;

 private:
  std::string lose(const std::string& why, Time now);

  Pace pace_;
  std::string suspicion_;  // why no answer comes; empty: nobody knows
  Silence silence_;
  Time asked_{}, free_{}, rests_until_{};
  bool open_ = false, waiting_ = false;
};

/// For so many bytes there and back, with what drivers of ports and the system need beside.
Duration patience_for(std::size_t bytes, int baud);

}  // namespace prehend::robot
