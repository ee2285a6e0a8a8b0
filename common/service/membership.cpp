#include "common/service/membership.hpp"

namespace prehend::service {

dds::ParticipantOptions membership(const Config& config, const std::string& name,
                                   const std::string& role) {
  return {.name = name,
          .domain = static_cast<int>(config.integer("lab.domain")),
          .rig = config.text("lab.rig"),
          .network = {.profile = config.text("lab.network"),
                      .servers = config.names("lab.server"),
                      .peers = config.names("lab.peers"),
                      .listen = config.text("lab.listen"),
                      .keys = config.path("lab.keys"),
                      .insecure = config.flag("lab.insecure")},
          .role = role};
}

}  // namespace prehend::service
