#include "common/dds/permissions.hpp"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>

namespace prehend::dds {
namespace {

using tinyxml2::XMLElement;

constexpr std::string_view head = R"(<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xsi:noNamespaceSchemaLocation="http://www.omg.org/spec/DDS-SECURITY/20170901/omg_shared_ca_{}.xsd">
)";

constexpr std::string_view every_domain =
    "<domains><id_range><min>0</min><max>232</max></id_range></domains>";

std::string domains(const Scope& scope) {
  if (!scope.domain) return std::string(every_domain);
  return fmt::format("<domains><id>{}</id></domains>", *scope.domain);
}

std::string rule(std::string_view kind, const std::set<std::string, std::less<>>& topics,
                 const std::string& rig) {
  if (topics.empty()) return {};
  std::string rule = fmt::format("        <{}>\n          <topics>\n", kind);
  for (const std::string& topic : topics)
    rule += fmt::format("            <topic>{}</topic>\n", topic);
  return rule + fmt::format(
                    "          </topics>\n"
                    "          <partitions><partition>{}</partition></partitions>\n"
                    "        </{}>\n",
                    rig, kind);
}

/// The text of a child; an empty one where there is none.
std::string child(const XMLElement* parent, const char* name) {
  const XMLElement* found = parent ? parent->FirstChildElement(name) : nullptr;
  const char* text = found ? found->GetText() : nullptr;
  return text ? text : "";
}

}  // namespace

bool Scope::covers(std::string_view other_rig, int other_domain) const {
  return (rig == "*" || rig == other_rig) && (!domain || *domain == other_domain);
}

Expected<Scope> scope_of(const std::string& rig, int domain) {
  const auto plain = [](char c) {
    return static_cast<unsigned char>(c) > ' ' && c != '\x7f' &&
           std::string_view("*?[]\\<>&\"'").find(c) == std::string_view::npos;
  };
  if (rig.empty() || !std::all_of(rig.begin(), rig.end(), plain))
    return fail("is no name of one rig", "lab.rig = " + rig,
                "letters and digits, or --rig any for keys that hold everywhere");
  return Scope{rig, domain};
}

std::string text(const Scope& scope) {
  return (scope.rig == "*" ? "any rig" : "rig " + scope.rig) +
         (scope.domain ? fmt::format(" in domain {}", *scope.domain) : " in any domain");
}

Permissions min_permissions(Role role) {
  Permissions permissions;
  for (const TopicInfo& topic : topic_table) {
    if (may_write(role, topic)) permissions.writes.emplace(topic.name);
    if (may_read(role, topic)) permissions.reads.emplace(topic.name);
  }
  return permissions;
}

// Whole submessages are encrypted, so that a stranger can forge neither samples nor the heartbeats
// that would make readers give up samples; encrypting the payload as well would only cost time.
std::string governance_text() {
  return fmt::format(head, "governance") + fmt::format(R"(  <domain_access_rules>
    <domain_rule>
      {}
      <allow_unauthenticated_participants>false</allow_unauthenticated_participants>
      <enable_join_access_control>true</enable_join_access_control>
      <discovery_protection_kind>ENCRYPT</discovery_protection_kind>
      <liveliness_protection_kind>ENCRYPT</liveliness_protection_kind>
      <rtps_protection_kind>NONE</rtps_protection_kind>
      <topic_access_rules>
        <topic_rule>
          <topic_expression>*</topic_expression>
          <enable_discovery_protection>true</enable_discovery_protection>
          <enable_liveliness_protection>true</enable_liveliness_protection>
          <enable_read_access_control>true</enable_read_access_control>
          <enable_write_access_control>true</enable_write_access_control>
          <metadata_protection_kind>ENCRYPT</metadata_protection_kind>
          <data_protection_kind>NONE</data_protection_kind>
        </topic_rule>
      </topic_access_rules>
    </domain_rule>
  </domain_access_rules>
</dds>
)",
                                                       every_domain);
}

std::string text(const Permissions& permissions) {
  return fmt::format(head, "permissions") +
         fmt::format(R"(  <permissions>
    <grant name="{0}">
      <subject_name>{0}</subject_name>
      <validity><not_before>{1}</not_before><not_after>{2}</not_after></validity>
      <allow_rule>
        {3}
{4}{5}      </allow_rule>
      <default>DENY</default>
    </grant>
  </permissions>
</dds>
)",
                     permissions.subject, permissions.from, permissions.until,
                     domains(permissions.scope),
                     rule("publish", permissions.writes, permissions.scope.rig),
                     rule("subscribe", permissions.reads, permissions.scope.rig));
}

Expected<Permissions> read_permissions(std::string_view xml) {
  tinyxml2::XMLDocument document;
  const auto foreign = [] {
    return fail("these permissions are not as `prehend keys` makes them", "permissions",
                "make the key anew with `prehend keys add`");
  };
  if (document.Parse(xml.data(), xml.size()) != tinyxml2::XML_SUCCESS) return foreign();
  const XMLElement* element = document.FirstChildElement("dds");
  for (const char* name : {"permissions", "grant"})
    element = element ? element->FirstChildElement(name) : nullptr;
  if (!element || element->NextSiblingElement() || child(element, "default") != "DENY")
    return foreign();
  Permissions read;
  read.subject = child(element, "subject_name");
  const XMLElement* validity = element->FirstChildElement("validity");
  read.from = child(validity, "not_before");
  read.until = child(validity, "not_after");
  const XMLElement* allowed = element->FirstChildElement("allow_rule");
  const auto topics = [&](const char* kind, auto& into) {
    const XMLElement* list = allowed ? allowed->FirstChildElement(kind) : nullptr;
    list = list ? list->FirstChildElement("topics") : nullptr;
    for (const XMLElement* topic = list ? list->FirstChildElement("topic") : nullptr; topic;
         topic = topic->NextSiblingElement("topic"))
      if (const char* name = topic->GetText()) into.emplace(name);
  };
  for (const char* kind : {"publish", "subscribe"}) {
    const XMLElement* list = allowed ? allowed->FirstChildElement(kind) : nullptr;
    list = list ? list->FirstChildElement("partitions") : nullptr;
    if (list) read.scope.rig = child(list, "partition");
  }
  const XMLElement* ids = allowed ? allowed->FirstChildElement("domains") : nullptr;
  if (ids && ids->FirstChildElement("id")) {
    int domain = 0;
    if (ids->FirstChildElement("id")->QueryIntText(&domain) != tinyxml2::XML_SUCCESS)
      return foreign();
    read.scope.domain = domain;
  }
  if (read.scope.rig != "*" && !scope_of(read.scope.rig, 0)) return foreign();
  topics("publish", read.writes);
  topics("subscribe", read.reads);
  // Whatever else may stand in such a file gives itself away here.
  std::string again = text(read);
  std::erase_if(again, [](char c) { return c == '\r'; });
  std::string given(xml);
  std::erase_if(given, [](char c) { return c == '\r'; });
  if (given != again) return foreign();
  return read;
}

}  // namespace prehend::dds
