#include "membership.hpp"

namespace prehend::service {

dds::ParticipantOptions membership(const Config& config, const std::string& name) {
  return {.name = name,
          .domain = static_cast<int>(config.integer("lab.domain")),
          .rig = config.text("lab.rig"),
          .network = {.profile = config.text("lab.network"),
                      .servers = config.names("lab.server")}};
}

}  // namespace prehend::service
