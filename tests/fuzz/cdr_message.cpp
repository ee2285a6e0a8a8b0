// A damaged message of a known type: refused with a field's name, or a value that is the same after
// it was encoded and decoded again. Its time stamps are found, or it is left as it was. The first
// byte of an input says which type.
#include <nlohmann/json.hpp>

#include "common/recording/types/stamps.hpp"
#include "common/recording/types/value.hpp"
#include "services/recorder/tools/recording/table.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/mutation.hpp"
#include "tests/fuzz/type_texts.hpp"
#include "tests/unit/recording/random_message.hpp"

using namespace prehend;

namespace {

std::string text_of(const recording::types::Value& value) {
  return recording::types::to_json(value).dump(-1, ' ', false,
                                               nlohmann::ordered_json::error_handler_t::replace);
}

bool read(const recording::types::Structure& type, std::vector<std::uint8_t> message) {
  const auto value = recording::types::decode(type, message);
  fuzz::require(value || !value.error().where.empty(), "refused without a place");
  if (value) {
    const auto again = recording::types::decode(type, testing::encode(type, *value));
    fuzz::require(again && text_of(*again) == text_of(*value), "encoded and decoded it differs");
    const auto names = recorder::columns(type), row = recorder::cells(type, *value);
    fuzz::require(names.size() == row.size(), "a row that does not fit its table");
  }
  const auto before = message;
  const bool moved = recording::types::move_stamps(
      type, [](std::int64_t stamp) { return stamp ^ 1; }, message);
  fuzz::require(moved || message == before, "changed what it does not understand");
  fuzz::require(!moved || recording::types::move_stamps(
                              type, [](std::int64_t stamp) { return stamp ^ 1; }, message),
                "its own work is not understood");
  return value.has_value();
}

}  // namespace

int main(int argc, char** argv) {
  fuzz::Fuzzer fuzzer;
  const recording::types::Library contract = fuzz::contract();
  std::vector<const recording::types::Structure*> all;
  Random seed(1);
  for (const auto& [name, type] : contract.structures()) {
    all.push_back(type.get());
    for (int i = 0; i < 4; ++i) {
      const auto bytes = testing::encode(*type, testing::random_value(*type, seed), i == 3);
      fuzzer.seeds.push_back(static_cast<char>(all.size() - 1) +
                             std::string(bytes.begin(), bytes.end()));
    }
  }
  fuzzer.mutate = [](Random& random, std::string bytes) {
    // A length is a small number of 32 bits somewhere: a large one is what hurts.
    if (random.index(3) == 0 && bytes.size() > 9) {
      const std::size_t at = 1 + 4 * random.index((bytes.size() - 1) / 4);
      const std::uint32_t length =
          static_cast<std::uint32_t>(random.bits() >> (32 + random.index(32)));
      for (std::size_t i = 0; i < 4 && at + i < bytes.size(); ++i)
        bytes[at + i] = static_cast<char>(length >> (8 * i));
      return bytes;
    }
    return fuzz::mutate_bytes(random, std::move(bytes));
  };
  fuzzer.target = [&](const std::string& bytes) {
    if (bytes.empty()) return false;
    const auto which = static_cast<std::uint8_t>(bytes[0]);
    return read(*all[which % all.size()], {bytes.begin() + 1, bytes.end()});
  };
  return fuzz::run(fuzzer, argc, argv);
}
