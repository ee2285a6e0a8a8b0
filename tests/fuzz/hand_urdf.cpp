// Damaged URDF beside the hand.toml that belonged to it: refused with a reason, or a sound hand.
#include <console_bridge/console.h>

#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/hand_files.hpp"
#include "tests/fuzz/mutation.hpp"

using namespace prehend;

int main(int argc, char** argv) {
  console_bridge::noOutputHandler();  // urdfdom tells each of a million errors there
  const auto hands = fuzz::all_hands();
  fuzz::Fuzzer fuzzer;
  for (const fuzz::HandFiles& hand : hands) fuzzer.seeds.push_back(hand.urdf);
  fuzzer.mutate = [](Random& random, std::string text) {
    return fuzz::mutate_text(random, std::move(text), fuzz::mutate_xml);
  };
  fuzzer.target = [&](const std::string& urdf) {
    // The hand.toml of the robot that is named, as long as one is.
    const fuzz::HandFiles* files = &hands.front();
    for (const fuzz::HandFiles& hand : hands) {
      const std::size_t begin = hand.urdf.find("<robot name"), end = hand.urdf.find('>', begin);
      if (urdf.find(hand.urdf.substr(begin, end - begin)) != std::string::npos) files = &hand;
    }
    const auto hand = model::HandModel::parse(urdf, files->toml);
    fuzz::require(hand || !hand.error().what.empty(), "refused without a reason");
    if (hand) fuzz::require_sound(*hand);
    return hand.has_value();
  };
  return fuzz::run(fuzzer, argc, argv);
}
