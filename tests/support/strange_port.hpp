#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <thread>

#include "common/serial/pseudo_terminal.hpp"

namespace prehend::test {

/// A port at which somebody else is plugged in than the driver hopes for, as users report.
enum class Stranger { echo, boot, gps, other_baud, prompt };

class StrangePort {
 public:
  explicit StrangePort(Stranger who) : who_(who) {
    auto made = serial::PseudoTerminal::open({});
    if (!made) throw std::runtime_error(made.error().message());
    terminal_.emplace(std::move(*made));
    thread_ = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        const std::string said = terminal_->read(std::chrono::milliseconds(20));
        if (const std::string answer = answer_to(said); !answer.empty()) terminal_->write(answer);
      }
    });
  }

  const std::string& path() const { return terminal_->path(); }
  /// What must stand in the message.
  std::string quote() const {
    switch (who_) {
      case Stranger::echo:
        return "our own words come back";
      case Stranger::boot:
        return "«sketch v0.3 ready» (another device";
      case Stranger::gps:
        return "«$GPGGA,120000.00,5000.0000,N,00800.0000,...» (that is a GPS receiver";
      case Stranger::other_baud:
        return "«\\xfe\\x80\\xe6\\x1e\\xf8\\xfe\\x80\\xe6\\x1e\\xf8...» (no text and no answer: "
               "check the baud";
      case Stranger::prompt:
        return "ERROR 12: unknown command» (another device";
    }
    return {};
  }

 private:
  std::string answer_to(const std::string& said) {
    switch (who_) {
      case Stranger::echo:
        return said;
      case Stranger::boot:
        return said.empty() ? "" : "\r\nsketch v0.3 ready\r\n> ";
      case Stranger::gps:  // unasked
        return ++waits_ % 5 == 0
                   ? "$GPGGA,120000.00,5000.0000,N,00800.0000,E,1,08,1.0,100.0,M,,M,,*40\r\n"
                   : "";
      case Stranger::other_baud:
        return said.empty() ? "" : "\xfe\x80\xe6\x1e\xf8\xfe\x80\xe6\x1e\xf8\xfe\x80";
      case Stranger::prompt:
        return said.empty() ? "" : "ERROR 12: unknown command\r\n$ ";
    }
    return {};
  }

  Stranger who_;
  int waits_ = 0;
  std::optional<serial::PseudoTerminal> terminal_;
  std::jthread thread_;  // last: joined before the rest goes
};

inline constexpr Stranger all_strangers[] = {Stranger::echo, Stranger::boot, Stranger::gps,
                                             Stranger::other_baud, Stranger::prompt};

}  // namespace prehend::test
