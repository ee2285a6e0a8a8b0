// Damaged streams of an open glove: what is read is a hand that can be, and a whole line after any
// damage is read as it is.
#include "services/glove/core/joint_sensors.hpp"
#include "services/glove/devices/open_glove_line.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/mutation.hpp"

using namespace prehend;
using namespace prehend::glove;

int main(int argc, char** argv) {
  fuzz::Fuzzer fuzzer;
  fuzzer.seeds = {"A100B2047C4095D0E12F2048G2048P77(AB)12(EB)4000JNM\r\n",
                  open_glove::to_line(open_glove::Sample{{1, 2, 3, 4, 5}, {1, 6}}) +
                      open_glove::to_line(open_glove::Sample{{4095, 0, 4095, 0, 4095}, {}}),
                  "A0B250C500D1000E1000\n"};
  fuzzer.mutate = [](Random& random, std::string stream) {
    return fuzz::mutate_bytes(random, stream);
  };
  fuzzer.target = [](const std::string& stream) {
    const JointGains gains = *typical_gains(finger_sensors);
    open_glove::LineParser parser;
    bool any = false;
    const auto take = [&](const std::string& line) {
      if (const auto held = open_glove::parse_held_back(line)) {
        any = true;
        for (const double share : *held)
          fuzz::require(share >= 0 && share <= 1, "held back by more than all");
      }
      const auto sample = open_glove::parse(line);
      if (!sample) return;
      any = true;
      std::vector<double> counts(sample->fingers.begin(), sample->fingers.end());
      const auto q = joint_angles(counts, gains);
      fuzz::require(q.allFinite() && q == model::HumanHand(1).clamp(q), "no hand can do that");
      for (const std::uint8_t button : sample->held)
        fuzz::require(button >= 1 && button <= open_glove::buttons, "no such button");
    };
    for (std::size_t at = 0; at < stream.size(); at += 7)
      for (const std::string& line : parser.feed(stream.substr(at, 7))) take(line);
    (void)parser.feed("\n");
    const open_glove::Sample truth{{7, 77, 777, 0, 4095}, {2}};
    const auto lines = parser.feed(open_glove::to_line(truth));
    const auto read = lines.size() == 1 ? open_glove::parse(lines[0]) : std::nullopt;
    fuzz::require(read && read->fingers == truth.fingers && read->held == truth.held,
                  "out of phase after a whole line");
    return any;
  };
  return fuzz::run(fuzzer, argc, argv);
}
