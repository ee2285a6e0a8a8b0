// Damaged streams of a bird tracker, all records, buttons, groups and ranges: what comes out is in
// the sensor's range and orthonormal, every byte is accounted for, and the second whole record
// after any damage is read as it is.
#include <numbers>

#include "services/glove/devices/bird_protocol.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/mutation.hpp"

using namespace prehend;
using namespace prehend::glove::bird;

namespace {

/// The first byte of an input tells how the rest is to be read.
Layout layout_of(std::uint8_t byte) {
  constexpr std::array ranges{short_range, long_range, extended_scale};
  return {.format = formats[byte % formats.size()].format,
          .button = (byte / 7 & 1) != 0,
          .group = (byte / 14 & 1) != 0,
          .range = ranges[byte / 28 % ranges.size()]};
}

Eigen::Matrix3d some_rotation(Random& random) {
  return Eigen::Quaterniond(random.normal(), random.normal(), random.normal(), random.normal())
      .normalized()
      .toRotationMatrix();
}

void require_sound(const Record& record, const Layout& layout) {
  if (record.position)
    fuzz::require(
        record.position->allFinite() && record.position->cwiseAbs().maxCoeff() <= layout.range,
        "a position beyond the range");
  if (record.angles)
    fuzz::require(record.angles->cwiseAbs().maxCoeff() <= std::numbers::pi, "an angle too large");
  if (const auto R = record.rotation())
    fuzz::require(
        (*R * R->transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-9 && R->determinant() > 0,
        "no rotation");
  fuzz::require(record.button.has_value() == layout.button, "a button from nowhere");
  fuzz::require(record.address.has_value() == layout.group, "an address from nowhere");
}

}  // namespace

int main(int argc, char** argv) {
  fuzz::Fuzzer fuzzer;
  Random random(1);
  for (std::uint8_t byte = 0; byte < 84; ++byte) {
    std::string stream(1, static_cast<char>(byte));
    for (int n = 0; n < 8; ++n)
      stream +=
          encode(random.normal3(0.4), some_rotation(random), layout_of(byte), n % 4 + 1, n % 2);
    fuzzer.seeds.push_back(stream);
  }
  fuzzer.long_round = 1'000'000;
  fuzzer.mutate = [](Random& r, std::string stream) {
    const std::string records = fuzz::mutate_bytes(r, stream.substr(1));
    return stream[0] + records;
  };
  fuzzer.target = [](const std::string& input) {
    if (input.empty()) return false;
    const std::string_view stream = std::string_view(input).substr(1);
    const Layout layout = layout_of(static_cast<std::uint8_t>(input[0]));
    RecordParser parser(layout);
    std::size_t records = 0;
    // In pieces, as a line gives them.
    for (std::size_t at = 0; at < stream.size(); at += 7)
      for (const Record& record : parser.feed(stream.substr(at, 7))) {
        require_sound(record, layout);
        ++records;
      }
    fuzz::require(stream.size() == records * layout.length() + parser.garbage() + parser.pending(),
                  "bytes are not accounted for");
    const bool whole = parser.garbage() + parser.pending() == 0;
    const std::string after = encode({0.1, -0.2, 0.3}, Eigen::Matrix3d::Identity(), layout, 3, 1);
    parser.feed(after);
    const auto second = parser.feed(after);
    const auto truth = decode(after, layout);
    fuzz::require(second.size() == 1 && truth, "out of phase after two records");
    fuzz::require(second[0].position == truth->position && second[0].matrix == truth->matrix &&
                      second[0].angles == truth->angles && second[0].address == truth->address,
                  "out of phase after two records");
    return whole;
  };
  return fuzz::run(fuzzer, argc, argv);
}
