// Damaged samples of every topic, as a recording may hold them: refused, or a message that is the
// same after it was encoded and decoded again. The first byte of an input says which topic.
#include <nlohmann/json.hpp>

#include "common/dds/raw.hpp"
#include "common/recording/types/value.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/mutation.hpp"
#include "tests/fuzz/type_texts.hpp"
#include "tests/unit/recording/random_message.hpp"

using namespace prehend;

namespace {

using Bytes = std::vector<std::uint8_t>;

struct Case {
  const recording::types::Structure* type;
  std::function<bool(const recording::types::Structure& type, const Bytes& payload)> read;
};

/// Not its bytes: those between two fields are anything.
std::string text_of(const recording::types::Structure& type, const Bytes& payload) {
  const auto value = recording::types::decode(type, payload);
  if (!value) return value.error().message();
  return recording::types::to_json(*value).dump(-1, ' ', false,
                                                nlohmann::ordered_json::error_handler_t::replace);
}

template <class P>
Case case_of(const prehend::dds::Topic<P>& topic, const recording::types::Library& contract) {
  const recording::types::Structure* type = contract.find(topic.type_name());
  fuzz::require(type, "no such type: " + topic.type_name());
  return {type, [&topic](const recording::types::Structure& described, const Bytes& payload) {
            prehend::dds::RawSample sample;
            sample.payload = payload;
            typename P::type message, again;
            if (!prehend::dds::decode(topic, sample, message)) return false;
            sample.payload = prehend::dds::encode(topic, message);
            const std::string said = text_of(described, sample.payload);
            fuzz::require(prehend::dds::decode(topic, sample, again), "what it wrote is refused");
            fuzz::require(text_of(described, prehend::dds::encode(topic, again)) == said,
                          "encoded and decoded it differs");
            return true;
          }};
}

}  // namespace

int main(int argc, char** argv) {
  const recording::types::Library contract = fuzz::contract();
  const std::vector<Case> cases = std::apply(
      [&](const auto&... topics) { return std::vector<Case>{case_of(topics, contract)...}; },
      prehend::dds::typed_topics);
  fuzz::Fuzzer fuzzer;
  Random seed(1);
  for (std::size_t i = 0; i < cases.size(); ++i)
    for (const bool big_endian : {false, true}) {
      const Bytes bytes =
          testing::encode(*cases[i].type, testing::random_value(*cases[i].type, seed), big_endian);
      fuzzer.seeds.push_back(static_cast<char>(i) + std::string(bytes.begin(), bytes.end()));
    }
  fuzzer.mutate = [](Random& random, std::string bytes) {
    if (random.index(8) == 0)  // the encapsulation: four bytes of which few are good
      for (std::size_t at = 1; at < 5 && at < bytes.size(); ++at)
        bytes[at] = static_cast<char>(random.index(256));
    return fuzz::mutate_bytes(random, std::move(bytes));
  };
  fuzzer.target = [&](const std::string& bytes) {
    if (bytes.empty()) return false;
    const Case& chosen = cases[static_cast<std::uint8_t>(bytes[0]) % cases.size()];
    return chosen.read(*chosen.type, {bytes.begin() + 1, bytes.end()});
  };
  return fuzz::run(fuzzer, argc, argv);
}
