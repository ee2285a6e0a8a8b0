#include "services/console/core/access.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <optional>

#include "services/console/core/protocol.hpp"

namespace prehend::console {
namespace {

constexpr int bad_request = 400, unauthorized = 401, forbidden = 403, not_found = 404,
              not_allowed = 405, misdirected = 421;

Verdict refuse(int status, std::string what) {
  return {Route::refused, status, std::move(what), false};
}

bool same_name(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](unsigned char x, unsigned char y) {
    return std::tolower(x) == std::tolower(y);
  });
}

bool among(const std::vector<std::string>& names, std::string_view name) {
  return std::any_of(names.begin(), names.end(),
                     [&](const std::string& one) { return same_name(one, name); });
}

bool is_own(const Asked& asked, const Policy& policy) {
  return same_name(asked.origin, (policy.secure ? "https://" : "http://") + asked.host);
}

/// A part between `separator`s that begins with `name=`; what follows that.
std::string_view value_in(std::string_view text, std::string_view name, char separator) {
  while (!text.empty()) {
    std::string_view part = text.substr(0, text.find(separator));
    text.remove_prefix(std::min(part.size() + 1, text.size()));
    while (part.starts_with(' ')) part.remove_prefix(1);
    if (part.starts_with(name) && part.substr(name.size()).starts_with('='))
      return part.substr(name.size() + 1);
  }
  return {};
}

/// Orders are services of a socket at /?orders=TOKEN. A page of elsewhere may not give any, even if
/// it has got hold of the token.
bool may_order(const Asked& asked, const Policy& policy, std::string_view query) {
  return (asked.origin.empty() || is_own(asked, policy)) && !policy.order_token.empty() &&
         same_secret(value_in(query, "orders", '&'), policy.order_token);
}

Verdict judge_socket(const Asked& asked, const Policy& policy, std::string_view query) {
  // Programs that are no browsers send no origin; nobody sends them here behind their user's back.
  if (!asked.origin.empty() && !is_own(asked, policy) && !among(policy.viewers, asked.origin))
    return refuse(forbidden, "pages of this origin may not look (console.viewers)");
  const auto protocol = choose_subprotocol(asked.protocols);
  if (!protocol)
    return refuse(bad_request, "offer foxglove.sdk.v1 or foxglove.websocket.v1 as subprotocol");
  return {Route::socket, 0, std::string(*protocol), false, may_order(asked, policy, query)};
}

/// Whatever moves something: orders, consent, and the hand that a robot's follows.
Verdict judge_order(const Asked& asked, const Policy& policy, Route route) {
  if (asked.method != "POST") return refuse(not_allowed, "orders are posted");
  if (!is_own(asked, policy)) return refuse(forbidden, "orders come from the console's own page");
  if (policy.order_token.empty() || !same_secret(asked.token, policy.order_token))
    return refuse(forbidden, "the order has not the page's token; load the page anew");
  return {route, 0, "", false};
}

}  // namespace

bool same_secret(std::string_view a, std::string_view b) {
  unsigned differs = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    differs |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
  return differs == 0;
}

std::vector<std::string> names_of(std::string_view address, int port) {
  const std::string own = address.find(':') == std::string_view::npos
                              ? std::string(address)
                              : fmt::format("[{}]", address);
  std::vector<std::string> names;
  for (const std::string& host :
       {own, std::string("localhost"), std::string("127.0.0.1"), std::string("[::1]")})
    names.push_back(fmt::format("{}:{}", host, port));
  return names;
}

bool is_loopback(std::string_view address) {
  return address == "::1" || address == "localhost" ||
         (address.starts_with("127.") &&
          address.find_first_not_of("0123456789.") == std::string_view::npos);
}

Verdict judge(const Asked& asked, const Policy& policy) {
  // A name that somebody else's DNS has turned to this machine is none of ours.
  if (!among(policy.hosts, asked.host))
    return refuse(misdirected, "is not served under this name (console.hosts)");
  const std::size_t query = asked.target.find('?');
  const std::string path = asked.target.substr(0, query);
  const std::string_view behind = query == std::string::npos
                                      ? std::string_view()
                                      : std::string_view(asked.target).substr(query + 1);
  bool in_address = false;
  if (!policy.access_token.empty()) {
    in_address = same_secret(value_in(behind, "token", '&'), policy.access_token);
    if (!in_address && !same_secret(value_in(asked.cookie, "prehend", ';'), policy.access_token))
      return refuse(unauthorized, "open the address with its token: /?token=...");
  }
  if (path == "/order") return judge_order(asked, policy, Route::order);
  if (path == "/hand") return judge_order(asked, policy, Route::hand);
  if (path == "/consent") return judge_order(asked, policy, Route::consent);
  if (asked.method != "GET" && asked.method != "HEAD")
    return refuse(not_allowed, "only GET and HEAD");
  if (path == "/" && asked.upgrade) return judge_socket(asked, policy, behind);
  if (path == "/") return {Route::page, 0, "", in_address};
  for (const char* file : {"/page.js", "/page.css", "/licences.txt"})
    if (path == file) return {Route::file, 0, file, false};
  constexpr std::string_view tracking = "/hands/";
  if (path.starts_with(tracking)) return {Route::tracking, 0, path.substr(tracking.size()), false};
  return refuse(not_found, "there is only the page");
}

}  // namespace prehend::console
