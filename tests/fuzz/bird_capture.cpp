// Damaged captures of serial conversations: refused with a reason, or finite records.
#include "services/glove/devices/bird_capture.hpp"

#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/mutation.hpp"

using namespace prehend;
using namespace prehend::glove::bird;

namespace {

std::string escaped(std::string_view bytes) {
  std::string text;
  for (const char byte : bytes) {
    constexpr std::string_view digits = "0123456789ABCDEF";
    const auto value = static_cast<std::uint8_t>(byte);
    if (byte == '\\')
      text += "\\\\";
    else if (value >= ' ' && value <= '~')
      text += byte;
    else
      text += std::string("\\x") + digits[value >> 4] + digits[value & 15];
  }
  return text;
}

std::string conversation() {
  double time = 1.5;
  int number = 0;
  std::string text = "1.0  :    (DEBUG) # a comment\n\n";
  const auto say = [&](const char* who, std::string_view bytes) {
    text += std::to_string(time += 0.01) + "  :    (INFO) " + std::to_string(++number) + ". " +
            who + "[" + std::to_string(bytes.size()) + "] " + escaped(bytes) + "\n";
  };
  using namespace std::string_view_literals;
  say("command", "O\x03"sv);
  say("receive", "\x01\x00"sv);
  say("command", "M\x01"sv);
  for (const FormatInfo& format : formats) {
    say("command", std::string(1, format.command));
    say("command", "B");
    const Layout layout{.format = format.format, .button = true, .range = long_range};
    say("receive", encode({0.1, 0.2, -0.3}, Eigen::Matrix3d::Identity(), layout, 1, 1));
  }
  return text;
}

}  // namespace

int main(int argc, char** argv) {
  fuzz::Fuzzer fuzzer;
  fuzzer.seeds = {conversation()};
  fuzzer.long_round = 1'000'000;
  fuzzer.mutate = [](Random& random, std::string text) {
    return fuzz::mutate_text(random, std::move(text), fuzz::mutate_lines);
  };
  fuzzer.target = [](const std::string& text) {
    const auto capture = read_capture(text, "capture");
    fuzz::require(capture || !capture.error().what.empty(), "refused without a reason");
    if (!capture) return false;
    for (const CapturedRecord& captured : capture->records) {
      fuzz::require(std::isfinite(captured.time), "a time that is none");
      const Record& record = captured.record;
      fuzz::require(!record.position || record.position->cwiseAbs().maxCoeff() <= long_range,
                    "a position beyond the range");
      if (const auto R = record.rotation())
        fuzz::require((*R * R->transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-9,
                      "no rotation");
    }
    return capture->garbage == 0 && capture->unreadable_lines == 0;
  };
  return fuzz::run(fuzzer, argc, argv);
}
