#include "describe.hpp"

#include <map>
#include <memory>
#include <prehend/types/idl.hpp>
#include <prehend/types/schema_text.hpp>

#include "key_hash.hpp"

namespace prehend::recorder {

Expected<decltype(Heading::describe)> describe_types(std::string_view encoding) {
  auto contract = types::load_contract();
  if (!contract) return tl::unexpected(contract.error());
  // A function must be copyable, a library is not.
  auto library = std::make_shared<types::Library>(std::move(*contract));
  return [library,
          ros = encoding == "ros2msg"](const std::string& name) -> std::optional<Description> {
    const types::Structure* type = library->find(name);
    if (!type) return std::nullopt;
    return Description{
        ros ? mcap::Schema{0, types::ros2_name(name), "ros2msg", types::ros2msg(*type)}
            : mcap::Schema{0, name, "omgidl", types::omgidl(*type)},
        type->source ? *type->source : types::omgidl(*type)};
  };
}

Expected<std::function<dds::KeyOf(const std::string&)>> keys_of_types() {
  const auto contract = types::load_contract();
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
