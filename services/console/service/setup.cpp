#include "services/console/service/setup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <random>

#include "common/base/clock.hpp"
#include "common/base/file_text.hpp"
#include "common/keys/certificate.hpp"

namespace prehend::console {
namespace {

constexpr std::size_t min_token = 16;
constexpr std::string_view made_at_start = "self";

std::string random_token() {
  std::random_device device;
  std::string token;
  for (int i = 0; i < 4; ++i) token += fmt::format("{:08x}", device());
  return token;
}

/// The first line; nothing where no file is named.
Expected<std::string> token_in(const std::filesystem::path& file) {
  if (file.empty()) return std::string();
  auto text = read_file(file, "see console.token_file");
  if (!text) return tl::unexpected(text.error());
  const std::string token = text->substr(0, text->find_first_of("\r\n"));
  const bool safe = std::all_of(token.begin(), token.end(), [](unsigned char c) {
    return std::isalnum(c) || c == '-' || c == '_';
  });
  if (token.size() < min_token || !safe)
    return fail("its first line is no token", file.string(), "16 or more letters, digits, - and _");
  return token;
}

/// Empty texts: none is wanted.
Expected<keys::Identity> identity_of(const service::Config& config) {
  const std::string& certificate = config.text("console.certificate");
  if (certificate.empty()) return keys::Identity{};
  if (certificate == made_at_start) {
    const Time now = process_now();
    return keys::make_authority("Prehend console",
                                {now - keys::dated_back, now + std::chrono::days(365)});
  }
  const std::string hint = "see console.certificate and console.key";
  auto text = read_file(config.path("console.certificate"), hint);
  if (!text) return tl::unexpected(text.error());
  auto key = read_file(config.path("console.key"), hint);
  if (!key) return tl::unexpected(key.error());
  return keys::Identity{std::move(*text), std::move(*key)};
}

Error with_hint(Error error) {
  error.hint = "see console.address, console.port, console.certificate and console.key";
  return error;
}

}  // namespace

Expected<web::Server::Options> server_options(const service::Config& config) {
  const std::int64_t port = config.integer("console.port");
  if (port < 0 || port > 65535) return wrong_use("is no port", "console.port", "0 to 65535");
  web::Server::Options options;
  // Sixty pictures a second; twice as many when they are there.
  options.period = std::chrono::microseconds(16667);
  options.address = config.text("console.address");
  options.port = static_cast<int>(port);
  if (!is_loopback(options.address) &&
      (config.text("console.certificate").empty() || config.text("console.token_file").empty()))
    return fail("others than this machine would reach it", "console.address " + options.address,
                "needs console.certificate and console.token_file");
  auto identity = identity_of(config);
  if (!identity) return tl::unexpected(identity.error());
  options.certificate = std::move(identity->certificate);
  options.key = std::move(identity->key);
  return options;
}

Expected<Policy> policy_of(const service::Config& config) {
  auto token = token_in(config.path("console.token_file"));
  if (!token) return tl::unexpected(token.error());
  return Policy{.secure = !config.text("console.certificate").empty(),
                .hosts = {},
                .viewers = config.names("console.viewers"),
                .access_token = std::move(*token),
                .order_token = random_token()};
}

Expected<Pose> pose_of(const service::Config& config, const std::string& key) {
  const std::vector<double> v = config.numbers(key);
  if (v.size() != 7)
    return wrong_use("needs seven numbers: x y z in m, then the quaternion w x y z", key);
  auto X = checked_pose({v[0], v[1], v[2]}, {v[3], v[4], v[5], v[6]});
  if (!X) return wrong_use(X.error().what, key);
  return X;
}

std::filesystem::path tracking_folder() {
  const auto of = [](const char* name) { return std::getenv(name); };
  const char *data = of("XDG_DATA_HOME"), *home = of("HOME");
  const std::filesystem::path base =
      data && *data ? std::filesystem::path(data)
                    : std::filesystem::path(home ? home : "/") / ".local" / "share";
  return base / "prehend" / "hand-tracking";
}

Expected<Served> serve(const service::Config& config, Show& show) {
  const auto options = server_options(config);
  if (!options) return tl::unexpected(options.error());
  auto server = web::Server::listen(*options, show);
  if (!server) return tl::unexpected(with_hint(server.error()));
  const int port = (*server)->port();
  std::vector<std::string> hosts = names_of(options->address, port);
  for (const std::string& name : config.names("console.hosts")) {
    hosts.push_back(name);
    hosts.push_back(fmt::format("{}:{}", name, port));
  }
  show.set_hosts(hosts);
  const bool anywhere = options->address == "0.0.0.0" || options->address == "::";
  const std::string host =
      !config.names("console.hosts").empty() ? hosts.back() : hosts[anywhere ? 1 : 0];
  const std::string scheme = options->certificate.empty() ? "http" : "https";
  const std::string& token = show.policy().access_token;
  return Served{std::move(*server),
                fmt::format("{}://{}/{}", scheme, host, token.empty() ? "" : "?token=" + token)};
}

}  // namespace prehend::console
