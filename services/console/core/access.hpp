#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

/// Who may look, and who may give orders. A browser lets every site that its user opens connect to
/// this machine, so the headers of a request decide. Pure.
namespace prehend::console {

/// The head of an HTTP request, as far as it matters here. What is not there is empty.
struct Asked {
  std::string method, target;
  std::string host, origin;
  std::string token;  // X-Prehend-Token
  std::string cookie;
  bool upgrade = false;   // to a WebSocket
  std::string protocols;  // offered ones, separated by commas
};

struct Policy {
  bool secure = false;             // served over TLS
  std::vector<std::string> hosts;  // HOST:PORT by which this page is reached
  /// Other sites that may look, as http://HOST:PORT. None of them gives orders.
  std::vector<std::string> viewers;
  /// Without it nobody even looks; empty: everybody on this machine may.
  std::string access_token;
  /// Only the page that was served here knows it, and who was told it there.
  std::string order_token;
};

enum class Route : std::uint8_t { refused, page, file, tracking, socket, order, hand, consent };

struct Verdict {
  Route route = Route::refused;
  int status = 0;           // of a refusal
  std::string what;         // why, or the file's name, or the subprotocol
  bool set_cookie = false;  // the access token came in the address: the page keeps it as a cookie
  bool orders = false;      // over this socket they may be given
};

Verdict judge(const Asked& asked, const Policy& policy);

/// In a time that does not tell how much of it is right.
bool same_secret(std::string_view a, std::string_view b);

/// HOST:PORT by which a server at this address may be reached by who is on the same machine.
std::vector<std::string> names_of(std::string_view address, int port);

/// Nobody but this machine reaches it.
bool is_loopback(std::string_view address);

}  // namespace prehend::console
