#include "services/console/core/protocol.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "services/console/core/bytes.hpp"
#include "services/console/core/documents.hpp"

namespace prehend::console {
namespace {

/// Of one request; more is no viewer's.
constexpr std::size_t max_entries = 1000;
constexpr char message_code = 1, call_code = 2, response_code = 3;
constexpr std::size_t max_encoding = 64;

std::string dump(const Json& document) {
  return document.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::optional<std::uint32_t> id_of(const Json& value) {
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() > 0xffffffffU) return std::nullopt;
  return value.get<std::uint32_t>();
}

/// An array of the request; nothing is an empty one.
const Json& list_of(const Json& request, const char* name) {
  static const Json none = Json::array();
  const auto found = request.find(name);
  return found != request.end() && found->is_array() && found->size() <= max_entries ? *found
                                                                                     : none;
}

Subscribe read_subscribe(const Json& request) {
  Subscribe made;
  for (const Json& one : list_of(request, "subscriptions")) {
    if (!one.is_object() || !one.contains("id") || !one.contains("channelId")) continue;
    const auto subscription = id_of(one["id"]), channel = id_of(one["channelId"]);
    if (subscription && channel) made.all.push_back({*subscription, *channel});
  }
  return made;
}

Unsubscribe read_unsubscribe(const Json& request) {
  Unsubscribe made;
  for (const Json& one : list_of(request, "subscriptionIds"))
    if (const auto id = id_of(one)) made.subscriptions.push_back(*id);
  return made;
}

GetParameters read_get_parameters(const Json& request) {
  GetParameters made;
  for (const Json& name : list_of(request, "parameterNames"))
    if (name.is_string()) made.names.push_back(name.get<std::string>());
  if (const auto id = request.find("id"); id != request.end() && id->is_string())
    made.id = id->get<std::string>();
  return made;
}

bool is_space(char c) {
  return c == ' ' || c == '\t';
}

}  // namespace

std::optional<std::string_view> choose_subprotocol(std::string_view offered) {
  std::vector<std::string_view> names;
  while (!offered.empty()) {
    const std::size_t comma = std::min(offered.find(','), offered.size());
    std::string_view name = offered.substr(0, comma);
    offered.remove_prefix(std::min(comma + 1, offered.size()));
    while (!name.empty() && is_space(name.front())) name.remove_prefix(1);
    while (!name.empty() && is_space(name.back())) name.remove_suffix(1);
    names.push_back(name);
  }
  for (const std::string_view ours : subprotocols)
    if (std::find(names.begin(), names.end(), ours) != names.end()) return ours;
  return std::nullopt;
}

Request read_request(std::string_view text) {
  const Json request = Json::parse(text, nullptr, false);
  if (!request.is_object()) return Refused{"is no JSON object"};
  const auto found = request.find("op");
  if (found == request.end() || !found->is_string()) return Refused{"has no op"};
  const std::string op = found->get<std::string>();
  if (op == "subscribe") return read_subscribe(request);
  if (op == "unsubscribe") return read_unsubscribe(request);
  if (op == "getParameters") return read_get_parameters(request);
  if (op == "subscribeConnectionGraph") return WatchGraph{true};
  if (op == "unsubscribeConnectionGraph") return WatchGraph{false};
  // Parameters never change, so there is nothing to be told of; viewers ask all the same.
  if (op == "subscribeParameterUpdates" || op == "unsubscribeParameterUpdates") return Refused{};
  return Refused{"viewers only look: " + op.substr(0, 40) + " is not done here"};
}

std::string server_info(std::string_view name, std::string_view session,
                        const std::optional<Span>& recording, bool orders) {
  Json made{{"op", "serverInfo"},
            {"name", name},
            {"capabilities", {"parameters", "connectionGraph"}},
            {"supportedEncodings", Json::array()},
            {"metadata", Json::object()},
            {"sessionId", session}};
  if (orders) {
    made["capabilities"].push_back("services");
    made["supportedEncodings"].push_back("json");
  }
  if (recording) {
    made["capabilities"].push_back("playbackControl");
    made["dataStartTime"] = to_time(recording->begin_ns);
    made["dataEndTime"] = to_time(recording->end_ns);
  }
  return dump(made);
}

std::string advertisement(const std::vector<ChannelInfo>& channels) {
  Json listed = Json::array();
  for (const ChannelInfo& channel : channels)
    listed.push_back({{"id", channel.id},
                      {"topic", channel.topic},
                      {"encoding", channel.encoding},
                      {"schemaName", channel.schema_name},
                      {"schema", channel.schema},
                      {"schemaEncoding", channel.schema_encoding}});
  return dump({{"op", "advertise"}, {"channels", std::move(listed)}});
}

std::string status_message(int level, std::string_view message, std::string_view id) {
  return dump({{"op", "status"}, {"level", level}, {"message", message}, {"id", id}});
}

std::string parameter_values(const std::vector<Parameter>& parameters, const GetParameters& asked) {
  Json listed = Json::array();
  for (const Parameter& parameter : parameters)
    if (asked.names.empty() ||
        std::find(asked.names.begin(), asked.names.end(), parameter.name) != asked.names.end())
      listed.push_back({{"name", parameter.name}, {"value", parameter.value}});
  Json made{{"op", "parameterValues"}, {"parameters", std::move(listed)}};
  if (asked.id) made["id"] = *asked.id;
  return dump(made);
}

std::string graph_update(const std::vector<TopicEnds>& before, const std::vector<TopicEnds>& now) {
  Json published = Json::array(), subscribed = Json::array(), removed = Json::array();
  for (const TopicEnds& topic : now) {
    published.push_back({{"name", topic.topic}, {"publisherIds", topic.writers}});
    subscribed.push_back({{"name", topic.topic}, {"subscriberIds", topic.readers}});
  }
  for (const TopicEnds& topic : before)
    if (std::none_of(now.begin(), now.end(),
                     [&](const TopicEnds& other) { return other.topic == topic.topic; }))
      removed.push_back(topic.topic);
  return dump({{"op", "connectionGraphUpdate"},
               {"publishedTopics", std::move(published)},
               {"subscribedTopics", std::move(subscribed)},
               {"advertisedServices", Json::array()},
               {"removedTopics", std::move(removed)},
               {"removedServices", Json::array()}});
}

std::string service_advertisement(const std::vector<ServiceInfo>& services) {
  const auto side = [](const char* name, const std::string& schema) {
    return Json{{"encoding", "json"},
                {"schemaName", name},
                {"schemaEncoding", "jsonschema"},
                {"schema", schema}};
  };
  Json listed = Json::array();
  for (const ServiceInfo& service : services)
    listed.push_back({{"id", service.id},
                      {"name", service.name},
                      {"type", "prehend.Order"},
                      {"request", side("prehend.OrderRequest", service.request)},
                      {"response", side("prehend.OrderAnswer", service.response)}});
  return dump({{"op", "advertiseServices"}, {"services", std::move(listed)}});
}

std::optional<ServiceCall> read_service_call(std::string_view bytes) {
  if (!bytes.starts_with(call_code)) return std::nullopt;
  Bytes in(bytes.substr(1));
  ServiceCall made;
  made.service = in.number<std::uint32_t>();
  made.call = in.number<std::uint32_t>();
  made.encoding = in.text(max_encoding);
  if (!in.good()) return std::nullopt;
  made.request = in.rest();
  return made;
}

std::string service_response(const ServiceCall& call, std::string_view document) {
  constexpr std::string_view encoding = "json";
  std::string bytes(1, response_code);
  put_number(bytes, call.service);
  put_number(bytes, call.call);
  put_number(bytes, static_cast<std::uint32_t>(encoding.size()));
  bytes += encoding;
  bytes += document;
  return bytes;
}

std::string service_failure(const ServiceCall& call, std::string_view reason) {
  return dump({{"op", "serviceCallFailure"},
               {"serviceId", call.service},
               {"callId", call.call},
               {"message", reason}});
}

std::string message_head(std::uint32_t subscription, std::int64_t stamp_ns) {
  std::string head(1, message_code);
  put_number(head, subscription);
  put_number(head, static_cast<std::uint64_t>(stamp_ns));
  return head;
}

}  // namespace prehend::console
