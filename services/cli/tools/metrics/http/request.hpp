#pragma once

#include <cstddef>
#include <string>
#include <string_view>

/// As much of HTTP/1.1 [RFC9112] as one page that is read again and again needs.
namespace prehend::cli::http {

/// Bytes of a request, with all its fields.
inline constexpr std::size_t max_request = 8192;

/// What a client is to be answered.
struct Verdict {
  int status = 0;    // 200, 400, ...; 0: the request has not come to its end
  bool body = true;  // false: only the head was asked for
};

/// Judges what a client has sent so far, where one page is served at `path`. Pure.
Verdict judge(std::string_view received, std::string_view path);

/// The bytes of the answer. page: the body of a 200, in the text format of Prometheus.
std::string response(const Verdict& verdict, std::string_view page);

}  // namespace prehend::cli::http
