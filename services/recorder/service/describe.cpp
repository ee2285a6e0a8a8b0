#include "services/recorder/service/describe.hpp"

#include <map>
#include <memory>

#include "common/recording/types/idl.hpp"
#include "common/recording/types/schema_text.hpp"
#include "services/recorder/service/key_hash.hpp"

namespace prehend::recorder {

Expected<decltype(Heading::describe)> describe_types(std::string_view encoding) {
  auto contract = recording::types::load_contract();
  if (!contract) return tl::unexpected(contract.error());
  // A function must be copyable, a library is not.
  auto library = std::make_shared<recording::types::Library>(std::move(*contract));
  return [library,
          ros = encoding == "ros2msg"](const std::string& name) -> std::optional<Description> {
    const recording::types::Structure* type = library->find(name);
    if (!type) return std::nullopt;
    return Description{
        ros ? recording::mcap::Schema{0, recording::types::ros2_name(name), "ros2msg",
                                      recording::types::ros2msg(*type)}
            : recording::mcap::Schema{0, name, "omgidl", recording::types::omgidl(*type)},
        type->source ? *type->source : recording::types::omgidl(*type)};
  };
}

Expected<std::function<dds::KeyOf(const std::string&)>> keys_of_types() {
  const auto contract = recording::types::load_contract();
  if (!contract) return tl::unexpected(contract.error());
  std::map<std::string, KeyHash> hashes;
  for (const auto& [name, type] : contract->structures())
    if (const auto hash = KeyHash::of(*type)) hashes.emplace(name, *hash);
  return [hashes](const std::string& type) -> dds::KeyOf {
    const auto found = hashes.find(type);
    if (found == hashes.end()) return {};
    return [hash = found->second](std::span<const std::uint8_t> payload, bool key_only) {
      return key_only ? hash.of_key(payload) : hash.of_message(payload);
    };
  };
}

}  // namespace prehend::recorder
