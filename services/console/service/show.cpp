#include "services/console/service/show.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <span>
#include <utility>

#include "common/base/clock.hpp"
#include "common/base/file_text.hpp"
#include "common/base/log.hpp"
#include "common/base/log_format.hpp"
#include "common/recording/types/idl.hpp"
#include "common/recording/types/schema_text.hpp"
#include "services/console/core/hand_line.hpp"
#include "services/console/service/page/page.hpp"
#include "services/console/service/setup.hpp"

namespace prehend::console {
namespace {

constexpr const char* recorded = "this is a recording: nobody is there to be ordered";

/// A channel for each feed, then one for each topic of the lab.
std::vector<Hub::Channel> channels_of(const recording::types::Library& types) {
  std::vector<Hub::Channel> made;
  for (const FeedInfo& feed : feeds) {
    auto [opening, closing] = around(feed);
    made.push_back({{0, std::string(feed.topic), "json", std::string(feed.schema_name),
                     "jsonschema", json_schema(feed.feed)},
                    feed.queued,
                    std::move(opening),
                    std::move(closing)});
  }
  for (const dds::TopicInfo& topic : dds::topic_table) {
    const std::string name = topic.type_name();
    const recording::types::Structure* type = types.find(name);
    made.push_back({{0, std::string(topic.name), "cdr", recording::types::ros2_name(name),
                     "ros2msg", type ? recording::types::ros2msg(*type) : ""},
                    topic.qos.reader_depth == 0,
                    "",
                    ""});
  }
  return made;
}

std::vector<Parameter> parameters_of(const service::Config& config) {
  const std::string& hand = config.text("simulation.hand");
  if (hand.empty()) return {};
  auto urdf = read_file(model::hand_directory(hand) / "hand.urdf");
  if (!urdf) {
    log::warning(urdf.error());
    return {};
  }
  return {{"/robot_description", std::move(*urdf)}};
}

/// Nothing of others runs in the page, nobody frames it, and it speaks to its own server alone.
/// Hand tracking is WebAssembly.
constexpr const char* content_policy =
    "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; "
    "img-src 'self' data: blob:; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

Asked asked_of(const web::Request& request) {
  return {request.method,
          request.target,
          request.field("Host"),
          request.field("Origin"),
          request.field("X-Prehend-Token"),
          request.field("Cookie"),
          request.upgrade,
          request.field("Sec-WebSocket-Protocol")};
}

/// A client of the hub, as long as it is connected.
class Viewer final : public web::Channel {
 public:
  Viewer(Hub& hub, bool orders) : hub_(hub), client_(hub.connect(orders)) {}
  ~Viewer() override { hub_.disconnect(client_); }
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;

  void hear(std::string_view said, bool binary) override {
    if (binary)
      hub_.hear_bytes(client_, said);
    else
      hub_.hear(client_, said);
  }
  std::optional<web::Frame> next() override {
    auto frame = hub_.next(client_);
    if (!frame) return std::nullopt;
    return web::Frame{frame->binary, std::move(frame->head), std::move(frame->payload)};
  }
  bool overflowed() const override { return hub_.overflowed(client_); }

 private:
  Hub& hub_;
  Hub::Client client_;
};

std::string text_of(const dds::Guid& guid) {
  return {guid.begin(), guid.end()};
}

}  // namespace

Show::Hands::Hands(const service::Config& config) {
  for (const char* key : {"simulation.hand", "mapping.hand"}) {
    if (config.text(key).empty()) continue;
    auto model = model::HandModel::load(model::hand_directory(config.text(key)));
    if (model)
      known_.try_emplace(model->name(), std::move(*model));
    else
      log::warning(model.error());
  }
}

const model::HandModel* Show::Hands::find(const std::string& name) {
  auto known = known_.find(name);
  if (known == known_.end()) {
    if (known_.size() > 100) return nullptr;
    auto model = model::named_hand(name).and_then(model::HandModel::load);
    if (!model) log::warning(model.error());
    known = known_.emplace(name, model ? std::optional(std::move(*model)) : std::nullopt).first;
  }
  return known->second ? &*known->second : nullptr;
}

Expected<std::unique_ptr<Show>> Show::create(const service::Config& config, Options options) {
  auto types = recording::types::load_contract();
  if (!types) return tl::unexpected(types.error());
  const auto X_WC = pose_of(config, "camera.X_WC");
  if (!X_WC) return tl::unexpected(X_WC.error());
  auto hands = std::make_shared<Hands>(config);
  LabView view({.services = config.names("lab.services"),
                .camera = config.text("camera.name"),
                .X_WC = *X_WC,
                .hand = [raw = hands.get()](const std::string& name) { return raw->find(name); }});
  std::vector<ServiceInfo> services;
  if (options.give) services = services_for_orders();
  Hub hub({.session = std::to_string(options.now_ns()),
           .channels = channels_of(*types),
           .parameters = parameters_of(config),
           .recording = options.film ? std::optional(options.film->span()) : std::nullopt,
           .services = services});
  std::unique_ptr<Show> made(new Show(std::move(options), std::move(*types), std::move(view),
                                      std::move(hub), std::move(hands), std::move(services)));
  made->begin();
  made->round_.tell(made->hub_);
  return made;
}

Show::Show(Options options, recording::types::Library types, LabView view, Hub hub,
           std::shared_ptr<Hands> hands, std::vector<ServiceInfo> services)
    : options_(std::move(options)),
      services_(std::move(services)),
      types_(std::move(types)),
      hands_(std::move(hands)),
      fresh_(std::move(view)),
      hub_(std::move(hub)) {}

void Show::begin() {
  round_ = {};
  hub_.forget_all();
  last_.clear();
  view_ = fresh_;
  publish(view_.begin(options_.now_ns()));
}

std::variant<web::Answer, web::Upgrade> Show::answer(const web::Request& request) {
  const Verdict verdict = judge(asked_of(request), options_.policy);
  if (verdict.route == Route::socket)
    return web::Upgrade{verdict.what, std::make_unique<Viewer>(hub_, verdict.orders)};
  web::Answer made = answer(verdict, request.body);
  made.fields.insert(made.fields.end(), {{"Content-Security-Policy", content_policy},
                                         {"X-Content-Type-Options", "nosniff"},
                                         {"Referrer-Policy", "no-referrer"},
                                         {"Cross-Origin-Resource-Policy", "same-origin"}});
  return made;
}

web::Answer Show::answer(const Verdict& verdict, std::string_view body) {
  if (verdict.route == Route::order) return order(body);
  if (verdict.route == Route::hand) return hand(body);
  if (verdict.route == Route::consent) return consent(body);
  if (verdict.route == Route::tracking) return tracking(verdict.what);
  if (verdict.route == Route::page) return page(verdict.set_cookie);
  if (verdict.route == Route::file) {
    const page::File file = page::file(verdict.what);
    return {200, std::string(file.type), std::string(file.text)};
  }
  return web::plain(verdict.status == 0 ? 404 : verdict.status, verdict.what);
}

web::Answer Show::page(bool set_cookie) const {
  const Policy& policy = options_.policy;
  web::Answer made{200, "text/html; charset=utf-8",
                   page::html(options_.give ? policy.order_token : "", options_.no_hand)};
  if (set_cookie)
    made.fields.emplace_back("Set-Cookie", "prehend=" + policy.access_token +
                                               "; Path=/; HttpOnly; SameSite=Strict" +
                                               (policy.secure ? "; Secure" : ""));
  return made;
}

web::Answer Show::order(std::string_view body) {
  const auto order = read_order(body);
  if (!order) return web::plain(400, order.error().message());
  if (!options_.give) return web::plain(409, recorded);
  const nlohmann::json said{{"id", options_.give(*order)}};
  return {202, "application/json", said.dump()};
}

web::Answer Show::hand(std::string_view body) {
  if (!options_.hand) return web::plain(409, options_.no_hand);
  const auto line = hand_line(body, to_ns(process_now()), options_.X_TW);
  if (!line) return web::plain(400, line.error().message());
  options_.hand(*line);
  return web::plain(202, "sent");
}

web::Answer Show::consent(std::string_view body) {
  if (!options_.consent) return web::plain(409, recorded);
  auto said = take_consent(body);
  if (!said) return web::plain(400, said.error().message());
  return {202, "application/json", std::move(*said)};
}

Expected<std::string> Show::take_consent(std::string_view body) {
  const std::int64_t now = to_ns(process_now());
  const auto said = read_consent(body, now);
  if (!said) return tl::unexpected(said.error());
  options_.consent(*said);
  return consent_answer(now);
}

void Show::obey(const Hub::Call& call) {
  std::string_view action = services_[call.asked.service].name;
  action.remove_prefix(order_services.size());
  if (action == "consent") return hub_.answer(call, take_consent(call.asked.request));
  const auto order = read_order(action, call.asked.request);
  if (!order) return hub_.answer(call, tl::unexpected(order.error()));
  desk_.add(options_.give(*order), order->target.empty(), call, process_now());
}

void Show::answer(const std::vector<Desk::Answer>& answers) {
  for (const auto& [call, document] : answers) hub_.answer(call, document);
}

/// Only what was fetched has a name here, so nobody reads another file by it.
web::Answer Show::tracking(const std::string& name) const {
  const std::string_view type = page::tracking_type(name);
  if (type.empty()) return web::plain(404, "belongs to no hand tracking");
  auto bytes = read_file(options_.tracking / name);
  if (!bytes)
    return web::plain(404, "is not installed: services/console/service/page/hand-tracking/fetch");
  return {200, std::string(type), std::move(*bytes)};
}

void Show::tick() {
  const Time now = process_now();
  const bool once_a_second = now >= next_second_;
  // Nobody looks: it is enough to keep up with what is to be kept.
  if (hub_.clients() == 0 && !once_a_second) return;
  Film* film = options_.film;
  if (film)
    for (const PlaybackRequest& request : hub_.take_requests()) film->obey(request);
  for (const Hub::Call& call : hub_.take_calls()) obey(call);
  answer(desk_.wait(now));
  const std::vector<Letter> letters = options_.letters();
  if (const auto state = film ? film->news(now) : std::nullopt) {
    if (state->sought) begin();
    hub_.tell_playback(*state);
  }
  for (const Letter& letter : letters) hand_on(letter);
  publish(view_.wait(options_.now_ns()));
  round_.tell(hub_);
  if (!once_a_second) return;
  next_second_ = now + std::chrono::seconds(1);
  hub_.tell_losses();
  if (options_.graph)
    if (auto graph = options_.graph()) hub_.set_graph(std::move(*graph));
}

void Show::hand_on(const Letter& letter) {
  const dds::TopicInfo& topic = dds::topic_table[letter.topic];
  const auto channel = static_cast<std::uint32_t>(feeds.size() + letter.topic);
  const std::string key =
      topic.qos.reader_depth == 0 ? std::to_string(queued_++) : text_of(letter.instance);
  const std::pair instance{letter.topic, letter.instance};
  const std::int64_t heard_ns = letter.heard_ns ? letter.heard_ns : options_.now_ns();
  if (!letter.payload) {
    round_.put(channel, key, 0, nullptr, true);
    if (auto last = last_.extract(instance))
      publish(view_.lose(topic.name, last.mapped(), heard_ns));
    return;
  }
  round_.put(channel, key, letter.sent_ns, letter.payload, false);
  const recording::types::Structure* type = types_.find(topic.type_name());
  if (!type) return;
  const std::string& bytes = *letter.payload;
  auto value = recording::types::decode(
      *type, {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
  if (!value) return;
  publish(view_.hear(topic.name, *value, heard_ns));
  if (topic.name == dds::operator_reply.name) answer(desk_.hear(View(*value)));
  // Pictures are large, and nothing is said of their end.
  if (topic.qos.reader_depth != 0 && topic.name != dds::camera_image.name)
    last_.insert_or_assign(instance, std::move(*value));
}

void Show::publish(Documents documents) {
  for (Document& document : documents) {
    const auto channel = static_cast<std::uint32_t>(document.feed);
    round_.put(channel, document.key, document.stamp_ns,
               std::make_shared<const std::string>(std::move(document.text)), document.last);
  }
}

}  // namespace prehend::console
