#include "services/cli/tools/metrics/metrics_site.hpp"

#include <optional>
#include <string_view>

namespace prehend::cli {
namespace {

/// The path of a target: behind «http://HOST» where a proxy has put that, and without a query.
std::optional<std::string_view> path_of(std::string_view target) {
  if (target.starts_with("http://")) {
    const std::size_t at = target.find('/', 7);
    target = at == std::string_view::npos ? "/" : target.substr(at);
  }
  if (target.empty() || (target[0] != '/' && target != "*")) return std::nullopt;
  return target.substr(0, target.find('?'));
}

}  // namespace

std::variant<web::Answer, web::Upgrade> MetricsSite::answer(const web::Request& request) {
  const auto path = path_of(request.target);
  if (!path) return web::plain(400, "Bad Request");
  if (*path != "/metrics") return web::plain(404, "Not Found");
  if (request.method != "GET" && request.method != "HEAD") {
    web::Answer refusal = web::plain(405, "Method Not Allowed");
    refusal.fields.emplace_back("Allow", "GET, HEAD");
    return refusal;
  }
  return web::Answer{200, "text/plain; version=0.0.4; charset=utf-8", page_()};
}

}  // namespace prehend::cli
