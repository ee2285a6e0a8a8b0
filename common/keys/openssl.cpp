#include "common/keys/openssl.hpp"

#include <openssl/err.h>
#include <openssl/pem.h>

namespace prehend::keys::openssl {
namespace {

/// Nobody is asked for a password: a key that needs one is refused.
int no_password(char*, int, int, void*) {
  return -1;
}

}  // namespace

tl::unexpected<Error> failed(std::string what, std::string where, std::string hint) {
  if (const unsigned long code = ERR_peek_last_error(); code != 0)
    if (const char* reason = ERR_reason_error_string(code)) what += std::string(": ") + reason;
  ERR_clear_error();
  return fail(std::move(what), std::move(where), std::move(hint));
}

Bio reading(std::string_view text) {
  return Bio(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())));
}

Bio writing() {
  return Bio(BIO_new(BIO_s_mem()));
}

std::string text_of(const Bio& bio) {
  char* data = nullptr;
  const long size = BIO_get_mem_data(bio.get(), &data);
  return size > 0 ? std::string(data, static_cast<std::size_t>(size)) : std::string();
}

Expected<Certificate> certificate_of(std::string_view pem) {
  Certificate made(PEM_read_bio_X509(reading(pem).get(), nullptr, no_password, nullptr));
  if (!made) return failed("is no certificate");
  return made;
}

Expected<Key> key_of(std::string_view pem) {
  Key made(PEM_read_bio_PrivateKey(reading(pem).get(), nullptr, no_password, nullptr));
  if (!made) return failed("is no private key");
  return made;
}

Expected<RevocationList> list_of(std::string_view pem) {
  RevocationList made(PEM_read_bio_X509_CRL(reading(pem).get(), nullptr, no_password, nullptr));
  if (!made) return failed("is no certificate revocation list");
  return made;
}

}  // namespace prehend::keys::openssl
