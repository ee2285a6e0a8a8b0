// Damaged datagrams of a hand tracking program: their documents are parts of them, in order; each
// is refused with a reason, or is 21 finite points within reach, whose sensors are sound.
#include "services/glove/devices/landmark_line.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/mutation.hpp"

using namespace prehend;
using namespace prehend::glove;

int main(int argc, char** argv) {
  fuzz::Fuzzer fuzzer;
  for (const bool webxr : {false, true})
    for (const bool left : {false, true}) {
      LandmarkLine line{.left = left, .in_room = webxr, .points = {}};
      line.points = landmarks_of(model::HumanHand(1), model::HumanHand::open_posture());
      if (left) line.stamp = 1732200000.125;
      fuzzer.seeds.push_back(to_line(line, webxr));
    }
  fuzzer.seeds.push_back(
      R"({"version": 1, "hand": "left", "origin": "room", "controller": {"position_m": [0.1, 0, 1], )"
      R"("orientation": [1, 0, 0, 0], "trigger": 0.5, "grip": 1}})");
  fuzzer.seeds.push_back(fuzzer.seeds[0] + fuzzer.seeds[1] + "\n" + fuzzer.seeds[2]);
  fuzzer.long_round = 1'000'000;
  fuzzer.mutate = [](Random& random, std::string line) {
    return random.index(3) == 0 ? fuzz::mutate_bytes(random, std::move(line))
                                : fuzz::mutate_number(random, std::move(line));
  };
  const auto is_sound = [](std::string_view text) {
    const auto line = parse_landmarks(text);
    fuzz::require(line || !line.error().empty(), "refused without a reason");
    if (!line) return false;
    for (const auto& point : line->points)
      fuzz::require(point.allFinite() && point.norm() <= 5, "a point out of reach");
    for (const bool held : {false, true}) {
      const auto frame = sensors_on(bare_hand(line->points, line->left), 1,
                                    held ? std::optional(make_pose({0, 0, 0.2})) : std::nullopt);
      if (!frame) continue;
      for (const Reading& reading : frame->readings) {
        const Eigen::Matrix3d R = reading.q_TS.toRotationMatrix();
        fuzz::require(reading.p_TS.allFinite() &&
                          (R * R.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-6,
                      "a sensor that is nowhere");
      }
    }
    return true;
  };
  fuzzer.target = [&](const std::string& datagram) {
    bool any = false;
    const char* behind = datagram.data();
    for (const std::string_view text : documents_in(datagram)) {
      fuzz::require(text.data() >= behind && !text.empty() &&
                        text.data() + text.size() <= datagram.data() + datagram.size(),
                    "a document that is not in the datagram");
      behind = text.data() + text.size();
      any = is_sound(text) || any;
    }
    return any;
  };
  return fuzz::run(fuzzer, argc, argv);
}
