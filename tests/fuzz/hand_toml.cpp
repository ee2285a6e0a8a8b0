// A damaged hand.toml beside the URDF that belonged to it: refused with a reason, or a sound hand.
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/hand_files.hpp"
#include "tests/fuzz/mutation.hpp"

using namespace prehend;

int main(int argc, char** argv) {
  const auto hands = fuzz::all_hands();
  fuzz::Fuzzer fuzzer;
  for (const fuzz::HandFiles& hand : hands) fuzzer.seeds.push_back(hand.toml);
  fuzzer.mutate = [](Random& random, std::string text) {
    return fuzz::mutate_text(random, std::move(text), fuzz::mutate_lines);
  };
  fuzzer.target = [&](const std::string& toml) {
    // The URDF of the hand that is named, as long as one is.
    const fuzz::HandFiles* files = &hands.front();
    for (const fuzz::HandFiles& hand : hands) {
      const std::size_t begin = hand.toml.find("name = ");
      if (toml.find(hand.toml.substr(begin, hand.toml.find('\n', begin) - begin)) !=
          std::string::npos)
        files = &hand;
    }
    const auto hand = model::HandModel::parse(files->urdf, toml);
    fuzz::require(hand || !hand.error().what.empty(), "refused without a reason");
    if (hand) fuzz::require_sound(*hand);
    return hand.has_value();
  };
  return fuzz::run(fuzzer, argc, argv);
}
