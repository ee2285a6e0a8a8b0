#include "describe.hpp"

#include <memory>
#include <prehend/types/idl.hpp>
#include <prehend/types/schema_text.hpp>

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

}  // namespace prehend::recorder
