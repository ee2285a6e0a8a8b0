// What a client may send: heads of requests, texts over the WebSocket, orders. Whatever it is, the
// hub has an answer of bounded size, nobody but the page gives an order, and nothing is written.
#include <nlohmann/json.hpp>

#include "services/console/core/access.hpp"
#include "services/console/core/consent.hpp"
#include "services/console/core/hand_line.hpp"
#include "services/console/core/hub.hpp"
#include "services/console/core/orders.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/mutation.hpp"

using namespace prehend;
using namespace prehend::console;

namespace {

const std::string secret = "0123456789abcdef";

/// Fields of a head stand on lines of their own, the body behind them.
Asked asked_of(const std::string& text, std::string& body) {
  std::vector<std::string> lines;
  std::size_t at = 0;
  for (int i = 0; i < 7 && at <= text.size(); ++i) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    lines.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  lines.resize(7);
  body = at <= text.size() ? text.substr(at) : "";
  return {lines[0],
          lines[1],
          lines[2],
          lines[3],
          lines[4],
          lines[5],
          lines[6].starts_with("u"),
          lines[6].empty() ? "" : lines[6].substr(1)};
}

Hub make_hub() {
  Hub::Options options;
  options.channels = {{{0, "/tf", "json", "a", "jsonschema", "{}"}, false, "[", "]"},
                      {{0, "/log", "json", "b", "jsonschema", "{}"}, true, "", ""}};
  options.parameters = {{"/robot_description", "<robot/>"}};
  options.recording = Span{1, 2};
  options.services = services_for_orders();
  return Hub(std::move(options));
}

/// A call of one who may order is answered once; of others none gets so far.
void call(const std::string& bytes) {
  Hub hub = make_hub();
  const Hub::Client viewer = hub.connect(), boss = hub.connect(true);
  while (hub.next(boss)) {
  }
  hub.hear_bytes(viewer, bytes);
  fuzz::require(hub.take_calls().empty(), "a viewer gives orders");
  hub.hear_bytes(boss, bytes);
  const std::vector<ServiceInfo> services = services_for_orders();
  for (const Hub::Call& one : hub.take_calls()) {
    const std::string action = services.at(one.asked.service).name.substr(order_services.size());
    const auto order = read_order(action, one.asked.request);
    if (order) fuzz::require(order->argument.size() < 128, "does not fit the contract");
    hub.answer(one, order.map([](const Order&) { return std::string("{}"); }));
  }
  int answers = 0;
  while (hub.next(boss)) ++answers;
  fuzz::require(answers == (read_service_call(bytes) ? 1 : 0), "is not answered once");
}

void hear(const std::string& text) {
  Hub hub = make_hub();
  const Hub::Client client = hub.connect();
  hub.publish(0, "hand", 1, std::make_shared<const std::string>("{}"));
  hub.hear(client, text);
  hub.hear(client, text);
  hub.hear_bytes(client, text);
  for (const PlaybackRequest& request : hub.take_requests())
    fuzz::require(request.speed > 0 && request.speed < 1e39, "plays at no speed");
  int frames = 0;
  while (const auto frame = hub.next(client)) {
    fuzz::require(++frames < 3000, "answers without end");
    if (frame->binary)
      fuzz::require(frame->head.size() == 13, "is no message");
    else
      fuzz::require(nlohmann::json::parse(*frame->payload)["op"].is_string(), "is no answer");
  }
}

}  // namespace

int main(int argc, char** argv) {
  fuzz::Fuzzer fuzzer;
  fuzzer.seeds = {
      "GET\n/\nlocalhost:1\nhttp://localhost:1\n\n\nufoxglove.websocket.v1, foxglove.sdk.v1\n"
      R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":0},{"id":2,"channelId":1}]})",
      "POST\n/order\nlocalhost:1\nhttp://localhost:1\n" + secret +
          "\n\n\n{\"action\":\"stop\",\"argument\":\"why\"}",
      "GET\n/?token=abc\nlocalhost:1\n\n\nprehend=abc; a=b\n\n"
      R"({"op":"getParameters","parameterNames":["/robot_description"],"id":"1"})",
      "GET\n/page.js\nlocalhost:1\n\n\n\n\n{\"op\":\"unsubscribe\",\"subscriptionIds\":[1,2]}",
      "GET\n/\nlocalhost:1\n\n\n\nufoxglove.sdk.v1\n{\"op\":\"subscribeConnectionGraph\"}"};
  // What a client sends to lead a recording, behind the head of a request.
  fuzzer.seeds.push_back(fuzzer.seeds[4].substr(0, fuzzer.seeds[4].rfind('\n') + 1) +
                         std::string("\x03\x00\x00\x00\x80\x3f\x01\x07\x06\x05\x04\x03\x02\x01"
                                     "\x00\x02\x00\x00\x00id",
                                     21));
  // And a call of a service: the order to place an object.
  fuzzer.seeds.push_back(fuzzer.seeds[4].substr(0, fuzzer.seeds[4].rfind('\n') + 1) +
                         std::string("\x02\x08\0\0\0\x01\0\0\0\x04\0\0\0json", 17) +
                         R"({"argument":"Talc","x":0.1,"y":-0.2})");
  std::string points = "[0.1,-0.2,0.3]";
  for (int i = 1; i < 21; ++i) points += ",[0.1,-0.2,0.3]";
  fuzzer.seeds.push_back(
      "POST\n/hand\nlocalhost:1\nhttp://localhost:1\n" + secret +
      "\n\n\n{\"hand\":\"left\",\"origin\":\"room\",\"age_s\":0.1,\"points_m\":[" + points + "]}");
  fuzzer.seeds.push_back("POST\n/consent\nlocalhost:1\nhttp://localhost:1\n" + secret +
                         "\n\n\n{\"hand\":\"hand\",\"held\":true,\"now_ms\":1700000000000}");
  fuzzer.long_round = 300'000;
  fuzzer.mutate = [](Random& random, std::string text) {
    return fuzz::mutate_text(random, std::move(text), fuzz::mutate_lines);
  };
  fuzzer.target = [](const std::string& text) {
    const Policy policy{.hosts = names_of("127.0.0.1", 1), .order_token = secret};
    std::string body;
    const Asked asked = asked_of(text, body);
    const Verdict verdict = judge(asked, policy);
    fuzz::require((verdict.route == Route::refused) == (verdict.status != 0), "is undecided");
    if (verdict.route == Route::order || verdict.route == Route::hand ||
        verdict.route == Route::consent)
      fuzz::require(asked.token == secret && asked.origin.size() == asked.host.size() + 7,
                    "anybody gives orders");
    if (verdict.route == Route::socket)
      fuzz::require(asked.protocols.find(verdict.what) != std::string::npos, "was not offered");
    hear(body);
    call(body);
    if (const auto line = hand_line(body, 1'700'000'000'000'000'000, Pose::Identity()))
      fuzz::require(nlohmann::json::parse(*line)["points_m"].size() >= 21, "is no hand");
    if (const auto consent = read_consent(body, 1'700'000'000'000'000'000))
      fuzz::require(!consent->hand.empty() && consent->hand.size() < 64, "is for no hand");
    const auto order = read_order(body);
    if (order) fuzz::require(order->argument.size() < 128, "does not fit the contract");
    return verdict.route != Route::refused;
  };
  return fuzz::run(fuzzer, argc, argv);
}
