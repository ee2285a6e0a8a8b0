#include "services/recognition/tools/objects/commands.hpp"

#include "common/service/arguments.hpp"

namespace prehend::recognition {

int broken(const Error& error) {
  return service::complain(error, exit_broken);
}

}  // namespace prehend::recognition
