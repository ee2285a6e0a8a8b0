// Damaged streams of a joint-angle glove: counts from 1 to 255 whose angles a hand can reach, every
// byte accounted for, and the second whole sample after any damage read as it is.
#include "services/glove/core/joint_sensors.hpp"
#include "services/glove/devices/joint_protocol.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/mutation.hpp"

using namespace prehend;
using namespace prehend::glove;

int main(int argc, char** argv) {
  fuzz::Fuzzer fuzzer;
  Random random(1);
  for (const std::size_t sensors : {min_joint_sensors, max_joint_sensors}) {
    std::string stream(1, static_cast<char>(sensors));
    for (int n = 0; n < 8; ++n) {
      joint::Counts counts(sensors);
      for (auto& count : counts) count = static_cast<std::uint8_t>(1 + random.index(255));
      stream += joint::encode(counts);
    }
    fuzzer.seeds.push_back(stream);
  }
  fuzzer.long_round = 1'000'000;
  fuzzer.mutate = [](Random& r, std::string stream) {
    const std::string samples = fuzz::mutate_bytes(r, stream.substr(1));
    return stream[0] + samples;
  };
  fuzzer.target = [](const std::string& input) {
    if (input.empty()) return false;
    const std::size_t sensors = input[0] == 22 ? max_joint_sensors : min_joint_sensors;
    const std::string_view stream = std::string_view(input).substr(1);
    const JointGains gains = *typical_gains(sensors);
    joint::RecordParser parser(sensors);
    std::size_t samples = 0;
    for (std::size_t at = 0; at < stream.size(); at += 7)
      for (const joint::Counts& counts : parser.feed(stream.substr(at, 7))) {
        ++samples;
        fuzz::require(counts.size() == sensors, "a sample of another length");
        const auto q = joint_angles(std::vector<double>(counts.begin(), counts.end()), gains);
        fuzz::require(q.allFinite() && q == model::HumanHand(1).clamp(q), "no hand can do that");
      }
    fuzz::require(stream.size() == samples * (sensors + 2) + parser.garbage() + parser.pending(),
                  "bytes are not accounted for");
    const bool whole = parser.garbage() + parser.pending() == 0;
    const joint::Counts truth(sensors, 77);
    parser.feed(joint::encode(truth));
    const auto second = parser.feed(joint::encode(truth));
    fuzz::require(second.size() == 1 && second[0] == truth, "out of phase after two samples");
    return whole;
  };
  return fuzz::run(fuzzer, argc, argv);
}
