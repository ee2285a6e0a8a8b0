// Damaged recordings of bare hands, Leap and 21 landmarks: refused with a reason, or frames with
// finite sensors and increasing stamps.
#include "services/glove/files/hand_recording.hpp"

#include "services/glove/core/bare_hand.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/mutation.hpp"

using namespace prehend;
using namespace prehend::glove;

namespace {

std::string vector(const Eigen::Vector3d& v) {
  return "," + std::to_string(v.x()) + "," + std::to_string(v.y()) + "," + std::to_string(v.z());
}

std::string columns(const std::string& name) {
  return "," + name + "_x," + name + "_y," + name + "_z";
}

Landmarks hand(int row) {
  const double closure = 0.1 * row;
  return landmarks_of(model::HumanHand(1),
                      model::HumanHand::posture({closure, closure, closure, closure, closure}));
}

std::string landmarks() {
  std::string text = "frame";
  for (int i = 0; i < 21; ++i) text += columns("l" + std::to_string(i));
  for (int row = 0; row < 6; ++row) {
    text += "\n" + std::to_string(row);
    for (const auto& point : hand(row)) text += vector(point);
  }
  return text + "\n";
}

std::string leap() {
  std::string text = "frame,t_us,fps,hand" + columns("palm") + columns("dir") + columns("normal") +
                     columns("middle_mcp");
  for (const std::string finger : {"thumb", "index", "middle", "ring", "pinky"})
    text += columns(finger + "_dip") + columns(finger + "_tip");
  for (int row = 0; row < 6; ++row) {
    const Landmarks points = hand(row);
    text += "\n" + std::to_string(row) + "," + std::to_string(1000000 + 9000 * row) + ",110," +
            (row % 3 == 2 ? "left" : "right") + vector({0, 200, 0}) + vector({1, 0, 0}) +
            vector({0, 0, -1}) + vector(1000 * points[9]);
    for (std::size_t f = 0; f < 5; ++f)
      text += vector(1000 * points[4 * f + 3]) + vector(1000 * points[4 * f + 4]);
  }
  return text + "\n";
}

}  // namespace

int main(int argc, char** argv) {
  fuzz::Fuzzer fuzzer;
  fuzzer.seeds = {landmarks(), leap()};
  fuzzer.long_round = 1'000'000;
  fuzzer.mutate = [](Random& random, std::string text) {
    return fuzz::mutate_text(random, std::move(text), fuzz::mutate_lines);
  };
  fuzzer.target = [](const std::string& text) {
    const auto recording = Recording::parse(text, "recording", {});
    fuzz::require(recording || !recording.error().what.empty(), "refused without a reason");
    if (!recording) return false;
    Time last{};
    for (std::size_t n = 0; n < recording->size(); ++n) {
      const auto frame = recording->frame(n);
      fuzz::require(frame && (n == 0 || frame->stamp > last), "stamps do not increase");
      last = frame->stamp;
      for (const Reading& reading : frame->readings)
        fuzz::require(reading.p_TS.allFinite() && reading.q_TS.coeffs().allFinite(),
                      "a sensor that is nowhere");
    }
    return recording->unreadable() == 0;
  };
  return fuzz::run(fuzzer, argc, argv);
}
