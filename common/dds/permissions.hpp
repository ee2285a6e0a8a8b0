#pragma once

#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "common/base/error.hpp"
#include "common/dds/topics.hpp"

/// Who may write and read what, from topic_table, as the texts of DDS Security that say so.
namespace prehend::dds {

/// Where a key holds.
struct Scope {
  std::string rig = "*";      // "*": in every rig
  std::optional<int> domain;  // nothing: in every domain
  bool covers(std::string_view other_rig, int other_domain) const;

  bool operator==(const Scope&) const = default;
};

/// In a rig and domain. Fails for a rig whose name would stand for others, too: * and ? do.
Expected<Scope> scope_of(const std::string& rig, int domain);

/// «rig lab in domain 0».
std::string text(const Scope& scope);

struct Permissions {
  std::string subject;      // of the certificate they are for, in the order of RFC 2253
  std::string from, until;  // UTC, 2026-11-21T17:00:00
  std::set<std::string, std::less<>> writes, reads;  // topics
  Scope scope;

  bool operator==(const Permissions&) const = default;
};

/// The least that a role needs, everywhere.
Permissions min_permissions(Role role);

/// The rules of the lab: only who is authenticated joins, and only what is permitted is written and
/// read; discovery, liveliness and all samples are encrypted.
std::string governance_text();

/// As DDS Security wants it: what is not allowed is denied.
std::string text(const Permissions& permissions);

/// What a text of this kind says. An error where it says more than text() can: such permissions
/// are not ours.
Expected<Permissions> read_permissions(std::string_view text);

}  // namespace prehend::dds
