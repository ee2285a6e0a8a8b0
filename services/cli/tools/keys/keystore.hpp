#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/time.hpp"
#include "common/dds/permissions.hpp"

namespace prehend::cli {

/// The lab's authority and the keys that it has made, in a folder of whoever looks after the lab:
///   authority.pem, authority-key.pem (keep this one to yourself), revoked.pem, governance.p7s
///   NAME/                 all that the process NAME needs: this goes to the host where it runs
class Keystore {
 public:
  /// A key, as it stands.
  struct Entry {
    std::string name;
    std::optional<dds::Role> role;  // nothing: its permissions are those of no role (any more)
    dds::Permissions permissions;
    Time expires{};
    bool revoked = false;
    std::optional<Error> trouble;  // why it cannot be used
  };

  /// An authority in a new folder, with a key for each role. Ten years, keys `validity`.
  static Expected<Keystore> init(const std::filesystem::path& folder, Duration validity, Time now,
                                 const dds::Scope& scope);
  static Expected<Keystore> open(const std::filesystem::path& folder);

  const std::filesystem::path& folder() const { return folder_; }
  /// A key with the least permissions of the role, within the scope. renew: in place of one of this
  /// name, which stays valid until it expires.
  Expected<void> add(const std::string& name, dds::Role role, Duration validity, bool renew,
                     Time now, const dds::Scope& scope) const;
  /// No longer vouches for the key of this name.
  Expected<void> revoke(const std::string& name, Time now) const;
  Expected<std::vector<Entry>> entries(Time now) const;

 private:
  explicit Keystore(std::filesystem::path folder) : folder_(std::move(folder)) {}
  Expected<std::string> read(const std::filesystem::path& name) const;
  std::vector<std::string> names() const;

  std::filesystem::path folder_;
};

/// "glove" and "glove-left" are gloves.
std::optional<dds::Role> role_of(std::string_view name);

}  // namespace prehend::cli
