#pragma once

#include <memory>
#include <string>

#include "common/service/config.hpp"
#include "common/web/server.hpp"
#include "services/console/service/show.hpp"

namespace prehend::console {

/// What the configuration says of address and safety. Fails where others than this machine would
/// reach a console without certificate and token.
Expected<web::Server::Options> server_options(const service::Config& config);
Expected<Policy> policy_of(const service::Config& config);
Expected<Pose> pose_of(const service::Config& config, const std::string& key);
/// Where hand tracking is fetched to.
std::filesystem::path tracking_folder();

/// A site that is served, and where.
struct Served {
  std::unique_ptr<web::Server> server;
  std::string address;  // https://lab:8765/?token=...
};
Expected<Served> serve(const service::Config& config, Show& show);

}  // namespace prehend::console
