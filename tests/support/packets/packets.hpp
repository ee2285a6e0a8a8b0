#pragma once

#include <string_view>
#include <utility>
#include <vector>

#include "common/dds/packet.hpp"

namespace prehend::test {

using Bytes = std::vector<std::uint8_t>;

/// Writes one RTPS message, part by part, as a middleware would.
class Message {
 public:
  explicit Message(const dds::GuidPrefix& sender, bool little_endian = true);

  /// A part as it is given.
  Message& part(std::uint8_t kind, const Bytes& content, std::uint8_t flags = 0);
  Message& timestamp();
  Message& source(const dds::GuidPrefix& sender);
  /// SPDP: the participant can be reached at these addresses.
  Message& announcement(const dds::GuidPrefix& participant, const std::vector<dds::Ipv4>& addresses,
                        Duration lease = std::chrono::seconds(20),
                        const std::vector<std::pair<std::uint16_t, Bytes>>& more = {});
  Message& departure(const dds::GuidPrefix& participant);
  /// SEDP: the participant has a writer.
  Message& endpoint(const dds::GuidPrefix& participant);
  /// It is alive.
  Message& liveliness(const dds::GuidPrefix& participant);
  /// A sample of a writer of users.
  Message& sample(std::size_t size = 100);

  /// Values of parameters: a text, and an identity token whose authority has this name.
  Bytes text(std::string_view text) const;
  Bytes token(std::string_view authority) const;

  const Bytes& bytes() const { return bytes_; }
  operator const Bytes&() const { return bytes_; }

 private:
  void two(Bytes& to, std::uint32_t value) const;
  void four(Bytes& to, std::uint32_t value) const;
  void parameter(Bytes& to, std::uint16_t id, const Bytes& value) const;
  Bytes locator(const dds::Ipv4& address) const;
  /// Of the writer with this entity's number; inline parameters where there are any.
  Message& data(std::uint32_t writer, const Bytes& parameters, const Bytes& content,
                std::uint8_t content_flag);
  Bytes list_head() const;

  bool little_endian_;
  Bytes bytes_;
};

/// Prefix number n.
dds::GuidPrefix participant(std::uint8_t n);

}  // namespace prehend::test
