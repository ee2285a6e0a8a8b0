#include "services/cli/tools/metrics/http/request.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

namespace prehend::cli::http {
namespace {

constexpr int max_fields = 100;

enum Status : int {
  ok = 200,
  bad_request = 400,
  not_found = 404,
  not_allowed = 405,
  too_large = 431,
  version_not_supported = 505
};

std::string_view reason_of(int status) {
  switch (status) {
    case ok:
      return "OK";
    case not_found:
      return "Not Found";
    case not_allowed:
      return "Method Not Allowed";
    case too_large:
      return "Request Header Fields Too Large";
    case version_not_supported:
      return "HTTP Version Not Supported";
    default:
      return "Bad Request";
  }
}

bool is_token(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
           std::string_view("!#$%&'*+-.^_`|~").find(c) != std::string_view::npos;
  });
}

bool is_visible(std::string_view text) {
  return !text.empty() &&
         std::all_of(text.begin(), text.end(), [](char c) { return c > 0x20 && c < 0x7f; });
}

/// Up to the separator, which is taken away with it; nothing: it is not there.
std::optional<std::string_view> take(std::string_view& text, std::string_view separator) {
  const std::size_t at = text.find(separator);
  if (at == std::string_view::npos) return std::nullopt;
  const std::string_view before = text.substr(0, at);
  text.remove_prefix(at + separator.size());
  return before;
}

bool same_name(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [&](char x, char y) { return lower(x) == lower(y); });
}

/// The path of a target: behind «http://HOST» where a proxy has put that, and without a query.
std::optional<std::string_view> path_of(std::string_view target) {
  if (target.starts_with("http://")) {
    const std::size_t at = target.find('/', 7);
    target = at == std::string_view::npos ? "/" : target.substr(at);
  }
  if (target.empty() || (target[0] != '/' && target != "*")) return std::nullopt;
  return target.substr(0, target.find('?'));
}

struct Line {
  int status = 0;  // 0: it is in order
  std::string_view method, path;
  bool needs_host = false;
};

Line request_line(std::string_view line) {
  const auto method = take(line, " ");
  const auto target = take(line, " ");
  if (!method || !target || !is_token(*method) || !is_visible(*target)) return {bad_request};
  const bool is_version = line.size() == 8 && line.starts_with("HTTP/") && line[6] == '.' &&
                          line[5] >= '0' && line[5] <= '9' && line[7] >= '0' && line[7] <= '9';
  if (!is_version) return {bad_request};
  if (line[5] != '1') return {version_not_supported};
  const auto path = path_of(*target);
  if (!path) return {bad_request};
  return {0, *method, *path, line[7] != '0'};
}

/// 0: the fields are in order.
int judge_fields(std::string_view fields, bool needs_host) {
  int count = 0, hosts = 0;
  while (const auto field = take(fields, "\r\n")) {
    if (++count > max_fields) return too_large;
    std::string_view value = *field;
    const auto name = take(value, ":");
    // A line that begins with a space goes on with the one before: nobody may write that any more.
    if (!name || !is_token(*name)) return bad_request;
    if (std::any_of(value.begin(), value.end(), [](char c) {
          return (static_cast<unsigned char>(c) < 0x20 && c != '\t') || c == 0x7f;
        }))
      return bad_request;
    if (same_name(*name, "host")) ++hosts;
  }
  return hosts > 1 || (needs_host && hosts == 0) ? bad_request : 0;
}

}  // namespace

Verdict judge(std::string_view received, std::string_view path) {
  const bool all = received.size() <= max_request;
  received = received.substr(0, max_request);
  const auto line = take(received, "\r\n");
  if (!line) return {all ? 0 : too_large};
  // What cannot become a request is not waited for.
  const Line asked = request_line(*line);
  if (asked.status != 0) return {asked.status};
  const bool body = asked.method != "HEAD";
  std::string_view fields;
  if (!received.starts_with("\r\n")) {
    const std::size_t end = received.find("\r\n\r\n");
    if (end == std::string_view::npos) return {all ? 0 : too_large, body};
    fields = received.substr(0, end + 2);
  }
  if (const int status = judge_fields(fields, asked.needs_host); status != 0) return {status, body};
  if (asked.path != path) return {not_found, body};
  return {asked.method == "GET" || asked.method == "HEAD" ? ok : not_allowed, body};
}

std::string response(const Verdict& verdict, std::string_view page) {
  const std::string said =
      verdict.status == ok ? std::string(page) : fmt::format("{}\n", reason_of(verdict.status));
  std::string text = fmt::format("HTTP/1.1 {} {}\r\n", verdict.status, reason_of(verdict.status));
  text += verdict.status == ok ? "Content-Type: text/plain; version=0.0.4; charset=utf-8\r\n"
                               : "Content-Type: text/plain; charset=utf-8\r\n";
  if (verdict.status == not_allowed) text += "Allow: GET, HEAD\r\n";
  text += fmt::format("Content-Length: {}\r\nCache-Control: no-store\r\nConnection: close\r\n\r\n",
                      said.size());
  if (verdict.body) text += said;
  return text;
}

}  // namespace prehend::cli::http
