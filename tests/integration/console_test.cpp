// The console as a process: who gets in, whose orders reach DDS, what late and stuck clients get.
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>

#include "common/base/time.hpp"
#include "common/dds/security.hpp"
#include "services/cli/tools/keys/keystore.hpp"
#include "tests/integration/rig.hpp"
#include "tests/integration/web_client.hpp"

namespace prehend::integration {
namespace {

using nlohmann::json;

class Console : public Rig {
 protected:
  void start_console(const Strings& sets = {}) {
    stage::Process::Options options;
    options.command = {program("prehend-console")};
    Strings all{"console.port=0"};
    all.insert(all.end(), sets.begin(), sets.end());
    for (const std::string& argument : lab_arguments(all)) options.command.push_back(argument);
    options.log = folder_ / "console.log";
    options.output = folder_ / "console.out";
    auto process = stage::Process::start(options);
    if (!process) throw std::runtime_error(process.error().message());
    console_.emplace(std::move(*process));
    ASSERT_TRUE(eventually(30, [&] {
      std::ifstream said(options.output);
      std::string line;
      if (!std::getline(said, line) || said.eof()) return false;
      EXPECT_TRUE(line.starts_with("http://127.0.0.1:")) << line;
      port_ = std::stoi(line.substr(line.rfind(':') + 1));
      return true;
    })) << "nothing is served";
  }

  std::string host() const { return "localhost:" + std::to_string(port_); }
  /// The token that the page carries.
  std::string token() const {
    const std::string page = ask(port_, "GET / HTTP/1.1\r\nHost: " + host());
    const std::string before = "name=\"prehend-token\" content=\"";
    const std::size_t at = page.find(before);
    if (at == std::string::npos) throw std::runtime_error("no page: " + page.substr(0, 400));
    const std::size_t from = at + before.size();
    return page.substr(from, page.find('"', from) - from);
  }
  std::string post(const std::string& head, const std::string& body) const {
    return ask(port_, "POST /order HTTP/1.1\r\n" + head, body);
  }
  std::string own() const { return "Host: " + host() + "\r\nOrigin: http://" + host() + "\r\n"; }

  /// Subscribes the topics by their names, each by the number of its channel.
  static std::map<std::uint32_t, std::string> subscribe(WebClient& client,
                                                        const std::set<std::string>& topics) {
    std::map<std::uint32_t, std::string> names;
    const auto told = client.hear_until(10, [](const WebClient::Message& message) {
      return !message.binary && message.bytes.find("\"advertise\"") != std::string::npos;
    });
    if (!told) return names;
    json asked{{"op", "subscribe"}, {"subscriptions", json::array()}};
    // By name: what a loop takes out of a temporary is gone before its first round.
    const json advertised = json::parse(told->bytes);
    for (const json& channel : advertised.at("channels")) {
      const auto topic = channel["topic"].get<std::string>();
      if (!topics.contains(topic)) continue;
      names[channel["id"].get<std::uint32_t>()] = topic;
      asked["subscriptions"].push_back({{"id", channel["id"]}, {"channelId", channel["id"]}});
    }
    client.say(asked.dump());
    return names;
  }

  /// Orders are told to those alone who are there.
  static bool hears_somebody(dds::Reader<v1::OperatorCommand>& orders) {
    return eventually(20, [&] {
      eprosima::fastdds::dds::SubscriptionMatchedStatus status;
      orders.raw().get_subscription_matched_status(status);
      return status.current_count > 0;
    });
  }

  /// Who is there knows the console before the console knows him: what it says meanwhile is lost.
  std::optional<v1::OperatorCommand> give_until_heard(dds::Reader<v1::OperatorCommand>& orders,
                                                      const std::string& head,
                                                      const std::string& body,
                                                      std::set<std::string>& given) const {
    std::optional<v1::OperatorCommand> heard;
    eventually(20, [&] {
      const std::string said = post(head, body);
      EXPECT_TRUE(said.starts_with("HTTP/1.1 202 ")) << said;
      given.insert(json::parse(said.substr(said.find("\r\n\r\n")))["id"].get<std::string>());
      heard = hear<v1::OperatorCommand>(orders, 1, [](const v1::OperatorCommand&) { return true; });
      return heard.has_value();
    });
    return heard;
  }

  std::optional<stage::Process> console_;
  int port_ = 0;
};

v1::HandState state_of(std::int64_t stamp) {
  v1::HandState state;
  state.hand("hand");
  state.model("barrett");
  state.stamp_ns(stamp);
  state.dof({0.1, 0.2, 0.3, 0.4});
  state.X_WB().position().z(0.3);
  state.X_WB().orientation().w(1);
  return state;
}

TEST_F(Console, OneProtocolOfThoseOfferedIsSpoken) {
  start_console();
  for (const auto& [offered, answered] : std::map<std::string, std::string>{
           {"foxglove.websocket.v1", "foxglove.websocket.v1"},
           {"foxglove.sdk.v1", "foxglove.sdk.v1"},
           {"foxglove.websocket.v1, foxglove.sdk.v1", "foxglove.sdk.v1"}}) {
    WebClient client(port_, offered);
    ASSERT_TRUE(client.open()) << client.answer();
    EXPECT_NE(client.answer().find("Sec-WebSocket-Protocol: " + answered + "\r\n"),
              std::string::npos)
        << client.answer();
    const auto first = client.hear(10);
    ASSERT_TRUE(first);
    EXPECT_EQ(json::parse(first->bytes)["op"], "serverInfo");
  }
  EXPECT_TRUE(WebClient(port_, "").answer().starts_with("HTTP/1.1 400 "));
  EXPECT_TRUE(WebClient(port_, "chat").answer().starts_with("HTTP/1.1 400 "));
  EXPECT_TRUE(WebClient(port_, "foxglove.sdk.v1", "Origin: https://evil.example\r\n")
                  .answer()
                  .starts_with("HTTP/1.1 403 "));
  const std::string page = ask(port_, "GET / HTTP/1.1\r\nHost: " + host());
  EXPECT_TRUE(page.starts_with("HTTP/1.1 200 ")) << page.substr(0, 200);
  EXPECT_NE(page.find("Content-Security-Policy: default-src 'none'"), std::string::npos);
  EXPECT_TRUE(ask(port_, "GET / HTTP/1.1\r\nHost: evil.example:" + std::to_string(port_))
                  .starts_with("HTTP/1.1 421 "));
  EXPECT_TRUE(
      ask(port_, "GET /../etc/passwd HTTP/1.1\r\nHost: " + host()).starts_with("HTTP/1.1 404 "));
  console_->signal(SIGTERM);
  const auto exit = console_->wait(seconds(20));
  ASSERT_TRUE(exit);
  EXPECT_EQ(exit->code, 0);
}

TEST_F(Console, OnlyThePagesOrdersReachTheLab) {
  auto orders = reader(dds::operator_command);
  auto replies = writer(dds::operator_reply);
  start_console();
  meet(replies);
  ASSERT_TRUE(hears_somebody(orders));
  const std::string secret = token(), stop = R"({"action":"stop","argument":"a test"})";
  const std::string with_token = "X-Prehend-Token: " + secret;
  const std::string evil = "Host: " + host() + "\r\nOrigin: https://evil.example\r\n";
  EXPECT_TRUE(post(evil + with_token, stop).starts_with("HTTP/1.1 403 "));
  EXPECT_TRUE(post(own() + "X-Prehend-Token: guess", stop).starts_with("HTTP/1.1 403 "));
  EXPECT_TRUE(post("Host: " + host() + "\r\n" + with_token, stop).starts_with("HTTP/1.1 403 "));
  EXPECT_TRUE(post("Host: evil.example\r\nOrigin: http://evil.example\r\n" + with_token, stop)
                  .starts_with("HTTP/1.1 421 "));
  EXPECT_TRUE(post(own() + with_token, R"({"action":"move"})").starts_with("HTTP/1.1 400 "));

  WebClient client(port_, "foxglove.sdk.v1");
  subscribe(client, {"/operator/reply"});
  // The first that comes is one that was allowed: none of the others has.
  std::set<std::string> allowed;
  const auto order = give_until_heard(orders, own() + with_token, stop, allowed);
  ASSERT_TRUE(order);
  const std::string id = order->id().to_string();
  EXPECT_TRUE(allowed.contains(id)) << id;
  EXPECT_EQ(order->action(), v1::ACTION_STOP);
  EXPECT_EQ(order->target().to_string(), "gate");
  EXPECT_EQ(order->argument().to_string(), "a test");

  v1::OperatorReply reply;
  reply.id(id.c_str());
  reply.service("gate");
  reply.done(true);
  reply.message("stopped");
  replies.write(reply);
  const auto shown = client.hear_until(20, [](const auto& message) { return message.binary; });
  ASSERT_TRUE(shown);
  EXPECT_EQ(json::parse(shown->payload())["id"], id);
  EXPECT_EQ(json::parse(shown->payload())["message"], "stopped");
}

TEST_F(Console, LateOnesSeeWhatWasSaidBefore) {
  auto states = writer(dds::robot_state);
  auto reports = writer(dds::grasp_report);
  start_console();
  meet(states);
  meet(reports);
  v1::GraspReport report;
  report.hand("hand");
  report.object("Talc");
  report.held(true);
  reports.write(report);
  WebClient first(port_, "foxglove.sdk.v1");
  const auto names = subscribe(first, {"/tf", "/grasp/report", "robot/state"});
  ASSERT_EQ(names.size(), 3U);
  // Best effort: again until it is there.
  ASSERT_TRUE(eventually(20, [&] {
    states.write(state_of(now_ns()));
    const auto heard = first.hear(0.2);
    return heard && heard->binary && names.at(heard->subscription()) == "/tf" &&
           json::parse(heard->payload())["transforms"].size() > 1;
  }));
  WebClient late(port_, "foxglove.websocket.v1");
  const auto again = subscribe(late, {"/tf", "/scene", "/grasp/report", "robot/state"});
  std::map<std::string, int> told;
  std::size_t frames = 0;
  late.hear_until(20, [&](const WebClient::Message& message) {
    if (!message.binary) return false;
    const std::string& topic = again.at(message.subscription());
    if (++told[topic] == 1 && topic == "/tf")
      frames = json::parse(message.payload())["transforms"].size();
    return told.size() == 4 && told["/scene"] > 5;
  });
  EXPECT_GT(frames, 5U) << "camera and links of the hand, at once";
  EXPECT_GT(told["/scene"], 5) << "table, links, contacts";
  EXPECT_EQ(told["/grasp/report"], 1);
  EXPECT_EQ(told["robot/state"], 1);
}

TEST_F(Console, WhoTakesNothingHarmsNobody) {
  auto images = writer(dds::camera_image);
  start_console();
  meet(images);
  WebClient stuck(port_, "foxglove.sdk.v1");
  subscribe(stuck, {"/camera/image", "camera/image"});
  WebClient healthy(port_, "foxglove.sdk.v1");
  subscribe(healthy, {"/camera/image"});
  v1::CameraImage image;
  image.camera("camera");
  image.encoding("jpeg");
  image.data(std::vector<std::uint8_t>(400000, 7));
  // Far more than the sockets of the stuck one hold.
  int taken = 0;
  ASSERT_TRUE(eventually(60, [&] {
    image.stamp_ns(now_ns());
    images.write(image);
    const auto heard = healthy.hear(0.5);
    if (heard && heard->binary) ++taken;
    return taken >= 60;
  })) << taken;
  const std::string page = ask(port_, "GET / HTTP/1.1\r\nHost: " + host());
  EXPECT_TRUE(page.starts_with("HTTP/1.1 200 "));
  // It is told what it missed as soon as it takes something.
  const auto missed = stuck.hear_until(20, [](const WebClient::Message& message) {
    return !message.binary && message.bytes.find("missed") != std::string::npos;
  });
  EXPECT_TRUE(missed);
}

/// The bytes of a service's call, as a client of the protocol writes them.
std::string call_bytes(std::uint32_t service, std::uint32_t call, const std::string& request) {
  std::string bytes = "\x02";
  for (const std::uint32_t number : {service, call, 4U})
    for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(number >> shift & 0xffU);
  return bytes + "json" + request;
}

// Orders of other programs than the page: services of the WebSocket, for those with its token.
// Long: that none of the refused calls came is seen by what comes first.
TEST_F(Console, OrdersAreServicesForThoseWithThePagesToken) {
  auto orders = reader(dds::operator_command);
  auto replies = writer(dds::operator_reply);
  start_console();
  meet(replies);
  ASSERT_TRUE(hears_somebody(orders));
  const std::string good = "/?orders=" + token(), protocol = "foxglove.sdk.v1";
  const auto advertised = [](WebClient& client,
                             double limit_s) -> std::map<std::string, std::uint32_t> {
    const auto told = client.hear_until(limit_s, [](const WebClient::Message& message) {
      return message.bytes.find("\"advertiseServices\"") != std::string::npos;
    });
    std::map<std::string, std::uint32_t> ids;
    if (!told) return ids;
    const json said = json::parse(told->bytes);
    for (const json& service : said.at("services"))
      ids[service["name"].get<std::string>()] = service["id"].get<std::uint32_t>();
    return ids;
  };
  const std::string call = call_bytes(0, 1, R"({"argument":"not allowed"})");
  const auto refused = [&](WebClient& client) {
    client.say_bytes(call);
    return client
        .hear_until(20,
                    [](const WebClient::Message& message) {
                      return message.bytes.find("viewers only look") != std::string::npos;
                    })
        .has_value();
  };
  // Without the token, with a wrong one: they look, and their calls end here.
  for (const char* target : {"/", "/?orders=guess"}) {
    WebClient viewer(port_, protocol, "", target);
    ASSERT_TRUE(viewer.open()) << viewer.answer();
    EXPECT_TRUE(refused(viewer)) << target;
  }
  EXPECT_TRUE(WebClient(port_, protocol, "Origin: https://evil.example\r\n", good)
                  .answer()
                  .starts_with("HTTP/1.1 403 "));

  WebClient client(port_, protocol, "", good);
  const auto ids = advertised(client, 20);
  ASSERT_TRUE(ids.contains("/operator/mode"));
  const auto answer = [&](std::uint32_t number) {
    return client.hear_until(20, [&](const WebClient::Message& message) {
      if (message.binary) return message.bytes.starts_with(std::string("\x03"));
      const json said = json::parse(message.bytes);
      return said["op"] == "serviceCallFailure" && said["callId"] == number;
    });
  };
  // Nobody executes it: that is the answer. The first order that comes is this one, none of those
  // before.
  std::optional<v1::OperatorCommand> order;
  std::uint32_t number = 0;
  ASSERT_TRUE(eventually(30, [&] {
    client.say_bytes(call_bytes(ids.at("/operator/mode"), ++number, R"({"argument":"direct"})"));
    order = hear<v1::OperatorCommand>(orders, 1, [](const auto&) { return true; });
    return order.has_value();
  }));
  EXPECT_EQ(order->argument().to_string(), "direct");
  EXPECT_EQ(order->action(), v1::ACTION_SET_MODE);
  const auto late = answer(number);
  ASSERT_TRUE(late);
  EXPECT_EQ(json::parse(late->bytes)["message"], "nobody answered within 3 s");

  // What is said of it is its answer: that it is done, or why not.
  for (const bool done : {true, false}) {
    client.say_bytes(
        call_bytes(ids.at("/operator/mode"), ++number, R"({"argument":"intelligent"})"));
    order = hear<v1::OperatorCommand>(
        orders, 20, [](const auto& one) { return one.argument().to_string() == "intelligent"; });
    ASSERT_TRUE(order);
    v1::OperatorReply reply;
    reply.id(order->id());
    reply.service("mapping");
    reply.done(done);
    reply.message(done ? "intelligent" : "not now");
    replies.write(reply);
    const auto said = answer(number);
    ASSERT_TRUE(said);
    EXPECT_EQ(said->binary, done) << said->bytes;
    EXPECT_NE(said->bytes.find(done ? R"("message":"intelligent")" : "mapping: not now"),
              std::string::npos)
        << said->bytes;
  }
  client.say_bytes(
      call_bytes(ids.at("/operator/place"), ++number, R"({"argument":"Talc","x":9,"y":0})"));
  const auto wrong = answer(number);
  ASSERT_TRUE(wrong);
  EXPECT_NE(wrong->bytes.find("beside the table"), std::string::npos) << wrong->bytes;
}

/// Where a glove would listen.
class Datagrams {
 public:
  Datagrams() : socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in own{};
    own.sin_family = AF_INET;
    own.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof own;
    if (::bind(socket_, reinterpret_cast<sockaddr*>(&own), size) != 0 ||
        ::getsockname(socket_, reinterpret_cast<sockaddr*>(&own), &size) != 0)
      throw std::runtime_error("no port for datagrams");
    port_ = ntohs(own.sin_port);
    const timeval limit{10, 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
  }
  ~Datagrams() { ::close(socket_); }
  Datagrams(const Datagrams&) = delete;
  Datagrams& operator=(const Datagrams&) = delete;
  std::string address() const { return "127.0.0.1:" + std::to_string(port_); }
  std::string next() const {
    std::string bytes(65536, '\0');
    const ssize_t count = ::recv(socket_, bytes.data(), bytes.size(), 0);
    bytes.resize(static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
    return bytes;
  }

 private:
  int socket_, port_ = 0;
};

TEST_F(Console, OnlyThePagesHandReachesTheGlove) {
  const Datagrams glove;
  start_console({"glove.device=landmarks", "glove.port=" + glove.address(),
                 "tracker.X_WT=[0, 0, 1, 1, 0, 0, 0]"});
  json points = json::array();
  for (int i = 0; i < 21; ++i) points.push_back({0.01 * i, 0.0, 0.25});
  const auto body = [&](const char* hand) {
    return json{{"hand", hand}, {"origin", "room"}, {"age_s", 0.01}, {"points_m", points}}.dump();
  };
  const auto post_hand = [&](const std::string& head, const char* hand) {
    return ask(port_, "POST /hand HTTP/1.1\r\n" + head, body(hand));
  };
  const std::string with_token = "X-Prehend-Token: " + token();
  const std::string evil = "Host: " + host() + "\r\nOrigin: https://evil.example\r\n";
  EXPECT_TRUE(post_hand(evil + with_token, "left").starts_with("HTTP/1.1 403 "));
  EXPECT_TRUE(post_hand(own() + "X-Prehend-Token: guess", "left").starts_with("HTTP/1.1 403 "));
  EXPECT_TRUE(
      post_hand("Host: evil.example\r\nOrigin: http://evil.example\r\n" + with_token, "left")
          .starts_with("HTTP/1.1 421 "));
  EXPECT_TRUE(ask(port_, "POST /hand HTTP/1.1\r\n" + own() + with_token, "[]")
                  .starts_with("HTTP/1.1 400 "));
  EXPECT_TRUE(post_hand(own() + with_token, "right").starts_with("HTTP/1.1 202 "));
  // The first that comes is the one that was allowed.
  const json heard = json::parse(glove.next());
  EXPECT_EQ(heard["hand"], "right");
  EXPECT_NEAR(heard["stamp_s"].get<double>(), 1e-9 * now_ns(), 10);
  EXPECT_NEAR(heard["points_m"][20][0].get<double>(), 0.2, 1e-5);
  EXPECT_NEAR(heard["points_m"][20][2].get<double>(), -0.75, 1e-5) << "in the tracker's frame";
}

TEST_F(Console, AnotherGloveIsNoPage) {
  start_console({"glove.device=synthetic"});
  const std::string page = ask(port_, "GET / HTTP/1.1\r\nHost: " + host());
  EXPECT_NE(page.find("name=\"prehend-no-hand\" content=\"glove.device = synthetic"),
            std::string::npos)
      << page.substr(0, 900);
  EXPECT_TRUE(ask(port_, "POST /hand HTTP/1.1\r\n" + own() + "X-Prehend-Token: " + token(), "{}")
                  .starts_with("HTTP/1.1 409 "));
}

// Who was killed says no farewell; who comes again is there again, without a new page.
TEST_F(Console, WhoIsKilledIsMissingUntilThereAgain) {
  start_console({"lab.services=[\"mapping\"]"});
  WebClient client(port_, "foxglove.sdk.v1");
  subscribe(client, {"/status"});
  const auto told_missing = [&](bool missing, double limit_s) {
    return client
        .hear_until(limit_s,
                    [&](const WebClient::Message& message) {
                      return message.binary &&
                             json::parse(message.payload())["missing"].empty() != missing;
                    })
        .has_value();
  };
  EXPECT_TRUE(told_missing(true, 10)) << "nobody has been started";
  auto mapping = start("mapping");
  ASSERT_TRUE(told_missing(false, 30));
  mapping.signal(SIGKILL);
  const std::int64_t killed = now_ns();
  // 3 s after its end, and what a loaded machine adds.
  ASSERT_TRUE(told_missing(true, 10));
  RecordProperty("seconds_until_missing", std::to_string(1e-9 * (now_ns() - killed)));
  mapping = start("mapping");
  EXPECT_TRUE(told_missing(false, 30));
}

TEST_F(Console, ConsentLastsAsLongAsItIsHeldInThePage) {
  auto consents = reader(dds::operator_consent);
  start_console();
  const std::string with_token = "X-Prehend-Token: " + token();
  const auto say = [&](const std::string& head, const json& body) {
    return ask(port_, "POST /consent HTTP/1.1\r\n" + head, body.dump());
  };
  const json let_go{{"hand", "hand"}, {"held", false}};
  const std::string evil = "Host: " + host() + "\r\nOrigin: https://evil.example\r\n";
  EXPECT_TRUE(say(evil + with_token, let_go).starts_with("HTTP/1.1 403 "));
  EXPECT_TRUE(say(own() + "X-Prehend-Token: guess", let_go).starts_with("HTTP/1.1 403 "));
  json held{{"hand", "hand"}, {"held", true}, {"now_ms", 1}};
  EXPECT_TRUE(say(own() + with_token, held).starts_with("HTTP/1.1 400 "));
  const auto now_ms = [](const std::string& answer) {
    return json::parse(answer.substr(answer.find("\r\n\r\n")))["now_ms"];
  };
  // The first that comes is held, though others were said before: none of those was taken for it.
  const auto heard = [&]() -> std::optional<v1::OperatorConsent> {
    held["now_ms"] = now_ms(say(own() + with_token, let_go));
    say(own() + with_token, held);
    return hear<v1::OperatorConsent>(consents, 0.2, [](const auto& one) { return one.held(); });
  };
  std::optional<v1::OperatorConsent> consent;
  ASSERT_TRUE(eventually(20, [&] { return (consent = heard()).has_value(); }));
  EXPECT_EQ(consent->hand().to_string(), "hand");
  EXPECT_NEAR(1e-9 * static_cast<double>(consent->stamp_ns() - now_ns()), 0, 5);
  const std::uint64_t number = consent->sequence_number();
  say(own() + with_token, let_go);
  consent = hear<v1::OperatorConsent>(consents, 10, [](const auto& one) { return !one.held(); });
  ASSERT_TRUE(consent);
  EXPECT_GT(consent->sequence_number(), number);
}

// The orders of its page, and what every service says of itself: no more. A viewer's keys permit
// none of it.
TEST_F(Console, InASecuredLabItGivesThePagesOrdersAndNoMore) {
  const auto keys = cli::Keystore::init(folder_ / "keys", std::chrono::days(365), from_ns(now_ns()),
                                        {name_, domain_});
  ASSERT_TRUE(keys) << keys.error().message();
  std::set<std::string> written;
  for (const dds::TopicInfo& topic : dds::topic_table) {
    if (dds::may_write(dds::Role::console, topic)) written.emplace(topic.name);
    EXPECT_FALSE(dds::may_write(dds::Role::viewer, topic)) << topic.name;
  }
  EXPECT_EQ(written,
            (std::set<std::string>{"operator/command", "operator/consent", "service/settings",
                                   "service/status", "lab/progress", "lab/beacon"}));
  network_.keys = keys->folder();
  join("mapping");
  auto orders = reader(dds::operator_command);
  start_console();
  ASSERT_TRUE(hears_somebody(orders));
  std::set<std::string> allowed;
  const auto order = give_until_heard(orders, own() + "X-Prehend-Token: " + token(),
                                      R"({"action":"stop"})", allowed);
  ASSERT_TRUE(order);
  EXPECT_EQ(order->action(), v1::ACTION_STOP);

  // Without the keys of the lab it does not start: it would show, and order, another lab.
  std::filesystem::remove(keys->folder() / "console" / dds::key_files::key);
  const Answer keyless = run("prehend-console", lab_arguments({"console.port=0"}), 30);
  EXPECT_EQ(keyless.exit_code, 3) << keyless.log;
  EXPECT_NE(keyless.log.find(dds::key_files::key), std::string::npos) << keyless.log;
}

TEST_F(Console, RefusesToServeOthersWithoutCertificateAndToken) {
  for (const char* address : {"0.0.0.0", "::", "192.0.2.1"}) {
    const Answer answer =
        run("prehend-console", lab_arguments({std::string("console.address=") + address}), 30);
    EXPECT_EQ(answer.exit_code, 3) << address;
    EXPECT_NE(answer.log.find("console.certificate"), std::string::npos) << answer.log;
    EXPECT_EQ(std::count(answer.log.begin(), answer.log.end(), '\n'), 1) << answer.log;
  }
}

}  // namespace
}  // namespace prehend::integration
