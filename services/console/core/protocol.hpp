#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

/// The Foxglove WebSocket protocol: texts and bytes of both sides. Pure.
namespace prehend::console {

/// Names of the protocol that are in use for the same format, the better one first.
inline constexpr std::string_view subprotocols[]{"foxglove.sdk.v1", "foxglove.websocket.v1"};

/// The one to answer to a client's list; nothing: it offers none of them.
std::optional<std::string_view> choose_subprotocol(std::string_view offered);

struct ChannelInfo {
  std::uint32_t id = 0;
  std::string topic, encoding, schema_name, schema_encoding, schema;
};

// What a client asks for.
struct Subscribe {
  struct One {
    std::uint32_t subscription = 0, channel = 0;
  };
  std::vector<One> all;
};
struct Unsubscribe {
  std::vector<std::uint32_t> subscriptions;
};
struct GetParameters {
  std::vector<std::string> names;  // none: all
  std::optional<std::string> id;
};
struct WatchGraph {
  bool wanted = false;
};
/// Known, and nothing that a viewer of ours may do; `what` says so to it. Empty: passed by.
struct Refused {
  std::string what;
};
using Request = std::variant<Subscribe, Unsubscribe, GetParameters, WatchGraph, Refused>;

/// What a text of a client asks for. Nothing in it is trusted; whatever it is, there is an answer.
Request read_request(std::string_view text);

/// From when to when a recording goes.
struct Span {
  std::int64_t begin_ns = 0, end_ns = 0;
};
/// recording: where one is shown, which clients may then lead. orders: the client may call
/// services.
std::string server_info(std::string_view name, std::string_view session,
                        const std::optional<Span>& recording = {}, bool orders = false);
std::string advertisement(const std::vector<ChannelInfo>& channels);
/// level: 0 information, 1 warning, 2 error.
std::string status_message(int level, std::string_view message, std::string_view id);

struct Parameter {
  std::string name, value;
};
std::string parameter_values(const std::vector<Parameter>& parameters, const GetParameters& asked);

/// Who publishes and who subscribes to a topic.
struct TopicEnds {
  std::string topic;
  std::vector<std::string> writers, readers;
};
/// From one graph to the next.
std::string graph_update(const std::vector<TopicEnds>& before, const std::vector<TopicEnds>& now);

/// Something that a client may ask for and that is answered. Requests and answers are JSON.
struct ServiceInfo {
  std::uint32_t id = 0;
  std::string name;
  std::string request, response;  // their JSON schemas
};
std::string service_advertisement(const std::vector<ServiceInfo>& services);

/// What a client asks of a service.
struct ServiceCall {
  std::uint32_t service = 0;
  std::uint32_t call = 0;  // the client's own number, which the answer carries
  std::string encoding, request;
};
/// From the bytes of a message; nothing: it is none.
std::optional<ServiceCall> read_service_call(std::string_view bytes);
/// The bytes of an answer.
std::string service_response(const ServiceCall& call, std::string_view document);
/// A text: why there is no answer.
std::string service_failure(const ServiceCall& call, std::string_view reason);

/// The bytes before the payload of a message for a subscription.
std::string message_head(std::uint32_t subscription, std::int64_t stamp_ns);

}  // namespace prehend::console
