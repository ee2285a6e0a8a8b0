#include "tests/fuzz/type_texts.hpp"

#include <nlohmann/json.hpp>

#include "common/recording/types/idl.hpp"
#include "common/recording/types/value.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/mutation.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend::fuzz {

recording::types::Library contract() {
  return recording::types::load_idl(test::in_sources("idl")).value();
}

std::string mutate_type_text(Random& random, std::string text,
                             const std::vector<std::string>& pieces) {
  return mutate_text(random, std::move(text), [&](Random&, std::string structured) {
    if (random.index(5) > 0) return mutate_lines(random, std::move(structured));
    const std::string& piece = pieces[random.index(pieces.size())];
    const std::size_t at = random.index(structured.size() + 1);
    const std::size_t times = random.index(10) == 0 ? 50'000 : 1 + random.index(3);
    std::string many;
    for (std::size_t k = 0; k < times; ++k) many += piece;
    return structured.insert(at, many);
  });
}

void decode_some(const recording::types::Structure& type) {
  for (const std::size_t length : {4, 5, 40, 2000})
    for (const std::uint8_t byte : {0, 1}) {
      std::vector<std::uint8_t> message(length, byte);
      message[0] = 0;
      const auto value = recording::types::decode(type, message);
      require(value || !value.error().what.empty(), "refused without a reason");
      if (!value) continue;
      for (const recording::types::Field& field : type.fields)
        require(value->find(field.name), "a field is missing");
      (void)recording::types::to_json(*value);
    }
}

}  // namespace prehend::fuzz
