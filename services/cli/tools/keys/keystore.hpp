#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/time.hpp"
#include "common/dds/permissions.hpp"
#include "common/keys/certificate.hpp"

namespace prehend::cli {

/// The folder of one key as texts. What goes from the authority to another machine has no private
/// key in it.
struct Bundle {
  std::string name;
  std::map<std::string, std::string> files;

  std::string text() const;
  static Expected<Bundle> parse(std::string_view text);
  Expected<void> write_to(const std::filesystem::path& folder) const;
};

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
    bool elsewhere = false;        // its private key is on the machine that asked for it
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
  /// Vouches for a key that was made elsewhere. role: otherwise that of its name.
  Expected<Bundle> sign(const std::string& request, std::optional<dds::Role> role,
                        Duration validity, Time now, const dds::Scope& scope) const;
  /// The next key of this name, with the role and the scope of the one that is there.
  Expected<void> renew(const std::string& name, Duration validity, Time now) const;
  /// Signs the list of revoked keys anew, for those who ask how old it is.
  Expected<void> refresh(Time now) const;
  /// No longer vouches for the key of this name.
  Expected<void> revoke(const std::string& name, Time now) const;
  Expected<std::vector<Entry>> entries(Time now) const;

 private:
  explicit Keystore(std::filesystem::path folder) : folder_(std::move(folder)) {}
  Expected<std::string> read(const std::filesystem::path& name) const;
  std::vector<std::string> names() const;
  Expected<keys::Identity> identity() const;
  Expected<Bundle> bundle_of(const std::string& name, const std::string& certificate,
                             dds::Role role, const keys::Validity& valid,
                             const dds::Scope& scope) const;
  Expected<void> write_list(std::vector<keys::Revoked> revoked, Time now) const;

  std::filesystem::path folder_;
};

/// Makes a key on this machine, and returns what asks for its certificate.
Expected<std::string> request_key(const std::filesystem::path& store, const std::string& name);
/// Installs what the authority granted, if it is whole and meant for the key that is here. Returns
/// the folder.
Expected<std::filesystem::path> install_keys(const std::filesystem::path& store, Bundle bundle,
                                             Time now);

}  // namespace prehend::cli
