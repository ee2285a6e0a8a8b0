#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/time.hpp"

/// Certificates, their revocation and signed texts: values in, values out, all in PEM and S/MIME as
/// DDS Security has them. Elliptic curve P-256, SHA-256. Made with OpenSSL.
namespace prehend::keys {

struct Validity {
  Time from, until;  // to the second
};

/// A certificate and the private key that belongs to it.
struct Identity {
  std::string certificate, key;
};

struct Facts {
  std::string subject;  // in the order of RFC 2253
  std::string issuer;
  std::string serial;  // hexadecimal
  Validity valid;
};

struct Revoked {
  std::string serial;
  Time when;
};

/// Clocks of other hosts may be behind: what is signed holds from so long ago.
inline constexpr std::chrono::days dated_back{1};

/// An authority that vouches for itself.
Expected<Identity> make_authority(std::string_view name, const Validity& valid);
/// An identity that the authority vouches for. unit: of its subject (OU); empty: it has none.
Expected<Identity> issue(const Identity& authority, std::string_view name, std::string_view unit,
                         const Validity& valid);
/// A private key that never leaves its machine, and what asks an authority elsewhere for its
/// certificate (PKCS #10).
struct Request {
  std::string text, key;
};
Expected<Request> request(std::string_view name);
/// Who asks; only the holder of the private key can have written that.
Expected<std::string> name_in(std::string_view request);
/// The certificate that is asked for.
Expected<std::string> grant(const Identity& authority, std::string_view request,
                            std::string_view unit, const Validity& valid);

/// The list of what the authority no longer vouches for.
Expected<std::string> revocation_list(const Identity& authority, const std::vector<Revoked>& gone,
                                      const Validity& valid);
/// The text with the authority's signature.
Expected<std::string> sign(const Identity& authority, std::string_view text);

Expected<Facts> facts(std::string_view certificate);
/// When the list was signed, if it was dated back.
Expected<Time> signed_at(std::string_view revocation_list);
/// Entries of a list that this authority has signed.
Expected<std::vector<Revoked>> revoked(std::string_view list, std::string_view authority);
/// The text that this authority has signed.
Expected<std::string> verified(std::string_view signed_text, std::string_view authority);
/// Is the certificate vouched for, not expired, not revoked, and is the key its own?
Expected<void> check(const Identity& identity, std::string_view authority,
                     std::string_view revocation_list, Time now);

}  // namespace prehend::keys
