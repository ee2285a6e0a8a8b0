#include "common/keys/certificate.hpp"

#include <openssl/asn1.h>
#include <openssl/bn.h>
#include <openssl/ec.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/rand.h>
#include <openssl/x509v3.h>

#include <array>
#include <utility>

#include "common/keys/openssl.hpp"

namespace prehend::keys {

using namespace openssl;

namespace {

using Number = Owned<BIGNUM, BN_free>;
using Integer = Owned<ASN1_INTEGER, ASN1_INTEGER_free>;
using Moment = Owned<ASN1_TIME, ASN1_TIME_free>;

std::time_t seconds_of(Time time) {
  return std::chrono::system_clock::to_time_t(
      std::chrono::time_point_cast<std::chrono::system_clock::duration>(time));
}

Time time_of(const ASN1_TIME* time) {
  std::tm parts{};
  if (ASN1_TIME_to_tm(time, &parts) != 1) return {};
  return Time(std::chrono::seconds(::timegm(&parts)));
}

std::string text_of_name(const X509_NAME* name) {
  const Bio bio = writing();
  X509_NAME_print_ex(bio.get(), name, 0, XN_FLAG_RFC2253 & ~ASN1_STRFLGS_ESC_MSB);
  return text_of(bio);
}

std::string text_of_serial(const ASN1_INTEGER* serial) {
  const Number number(ASN1_INTEGER_to_BN(serial, nullptr));
  char* digits = number ? BN_bn2hex(number.get()) : nullptr;
  const std::string text = digits ? digits : "";
  OPENSSL_free(digits);
  return text;
}

Integer serial_of(const std::string& text) {
  BIGNUM* raw = nullptr;
  if (BN_hex2bn(&raw, text.c_str()) == 0) return nullptr;
  const Number number(raw);
  return Integer(BN_to_ASN1_INTEGER(number.get(), nullptr));
}

/// 16 random bytes: two identities of one name differ.
Integer new_serial() {
  unsigned char bytes[16];
  if (RAND_bytes(bytes, sizeof bytes) != 1) return nullptr;
  bytes[0] &= 0x7f;
  const Number number(BN_bin2bn(bytes, sizeof bytes, nullptr));
  return Integer(BN_to_ASN1_INTEGER(number.get(), nullptr));
}

bool extend(X509* certificate, X509* issuer, int id, const char* value) {
  X509V3_CTX context;
  X509V3_set_ctx(&context, issuer, certificate, nullptr, nullptr, 0);
  const Owned<X509_EXTENSION, X509_EXTENSION_free> extension(
      X509V3_EXT_conf_nid(nullptr, &context, id, value));
  return extension && X509_add_ext(certificate, extension.get(), -1) == 1;
}

using Asking = Owned<X509_REQ, X509_REQ_free>;

bool put_name(X509_NAME* to, std::string_view name, std::string_view unit = {}) {
  const auto put = [&](const char* attribute, std::string_view text) {
    return X509_NAME_add_entry_by_txt(to, attribute, MBSTRING_UTF8,
                                      reinterpret_cast<const unsigned char*>(text.data()),
                                      static_cast<int>(text.size()), -1, 0) == 1;
  };
  return put("CN", name) && (unit.empty() || put("OU", unit));
}

Expected<std::string> text_of_key(EVP_PKEY* key) {
  const Bio text = writing();
  if (PEM_write_bio_PrivateKey(text.get(), key, nullptr, nullptr, 0, nullptr, nullptr) != 1)
    return failed("a key cannot be written");
  return text_of(text);
}

/// One that its own key has signed.
Expected<Asking> asking_of(std::string_view text) {
  const Bio in = reading(text);
  Asking asking(PEM_read_bio_X509_REQ(in.get(), nullptr, nullptr, nullptr));
  if (!asking) return failed("is no request for a certificate");
  EVP_PKEY* key = X509_REQ_get0_pubkey(asking.get());
  if (!key || X509_REQ_verify(asking.get(), key) != 1)
    return failed("the request is not signed by the key that it is for");
  if (EVP_PKEY_get_bits(key) != 256 || EVP_PKEY_get_base_id(key) != EVP_PKEY_EC)
    return failed("the request is for a key of another kind", {}, "elliptic curve P-256");
  return asking;
}

/// The certificate of a key. issuer: nothing, and the certificate vouches for itself.
Expected<std::string> certify(std::string_view name, std::string_view unit, EVP_PKEY* key,
                              const Validity& valid, X509* issuer, EVP_PKEY* issuer_key) {
  const Certificate certificate(X509_new());
  const Integer serial = new_serial();
  if (!certificate || !serial) return failed("a certificate cannot be made");
  X509* raw = certificate.get();
  bool good = X509_set_version(raw, 2) == 1 && X509_set_serialNumber(raw, serial.get()) == 1 &&
              X509_set_pubkey(raw, key) == 1 &&
              ASN1_TIME_set(X509_getm_notBefore(raw), seconds_of(valid.from)) &&
              ASN1_TIME_set(X509_getm_notAfter(raw), seconds_of(valid.until)) &&
              put_name(X509_get_subject_name(raw), name, unit);
  X509* by = issuer ? issuer : raw;
  good =
      good && X509_set_issuer_name(raw, X509_get_subject_name(by)) == 1 &&
      extend(raw, by, NID_basic_constraints, issuer ? "critical,CA:FALSE" : "critical,CA:TRUE") &&
      extend(raw, by, NID_key_usage,
             issuer ? "critical,digitalSignature,keyAgreement"
                    : "critical,digitalSignature,keyCertSign,cRLSign") &&
      X509_sign(raw, issuer ? issuer_key : key, EVP_sha256()) > 0;
  const Bio text = writing();
  if (!good || PEM_write_bio_X509(text.get(), raw) != 1)
    return failed("a certificate cannot be made", std::string(name));
  return text_of(text);
}

Expected<Identity> make(std::string_view name, std::string_view unit, const Validity& valid,
                        X509* issuer, EVP_PKEY* issuer_key) {
  const Key key(EVP_EC_gen("P-256"));
  if (!key) return failed("a key cannot be made");
  auto certificate = certify(name, unit, key.get(), valid, issuer, issuer_key);
  if (!certificate) return tl::unexpected(certificate.error());
  auto text = text_of_key(key.get());
  if (!text) return tl::unexpected(text.error());
  return Identity{std::move(*certificate), std::move(*text)};
}

/// Knows the authority, and the list when there is one.
Expected<Store> store_of(std::string_view authority, X509_CRL* list) {
  const auto root = certificate_of(authority);
  if (!root) return tl::unexpected(root.error());
  Store store(X509_STORE_new());
  bool good = store && X509_STORE_add_cert(store.get(), root->get()) == 1;
  if (list)
    good = good && X509_STORE_add_crl(store.get(), list) == 1 &&
           X509_STORE_set_flags(store.get(), X509_V_FLAG_CRL_CHECK) == 1;
  if (!good) return failed("cannot be used as an authority");
  return store;
}

}  // namespace

Expected<Identity> make_authority(std::string_view name, const Validity& valid) {
  return make(name, {}, valid, nullptr, nullptr);
}

Expected<Identity> issue(const Identity& authority, std::string_view name, std::string_view unit,
                         const Validity& valid) {
  const auto issuer = certificate_of(authority.certificate);
  if (!issuer) return tl::unexpected(issuer.error());
  const auto key = key_of(authority.key);
  if (!key) return tl::unexpected(key.error());
  return make(name, unit, valid, issuer->get(), key->get());
}

Expected<Request> request(std::string_view name) {
  const Key key(EVP_EC_gen("P-256"));
  const Asking asking(X509_REQ_new());
  const Bio text = writing();
  if (!key || !asking || X509_REQ_set_version(asking.get(), 0) != 1 ||
      !put_name(X509_REQ_get_subject_name(asking.get()), name) ||
      X509_REQ_set_pubkey(asking.get(), key.get()) != 1 ||
      X509_REQ_sign(asking.get(), key.get(), EVP_sha256()) <= 0 ||
      PEM_write_bio_X509_REQ(text.get(), asking.get()) != 1)
    return failed("a request cannot be made", std::string(name));
  auto secret = text_of_key(key.get());
  if (!secret) return tl::unexpected(secret.error());
  return Request{text_of(text), std::move(*secret)};
}

Expected<std::string> name_in(std::string_view text) {
  const auto asking = asking_of(text);
  if (!asking) return tl::unexpected(asking.error());
  std::array<char, 65> name{};
  const int length =
      X509_NAME_get_text_by_NID(X509_REQ_get_subject_name(asking->get()), NID_commonName,
                                name.data(), static_cast<int>(name.size()));
  if (length <= 0) return fail("the request has no name", {}, "make it by prehend keys request");
  return std::string(name.data(), static_cast<std::size_t>(length));
}

Expected<std::string> grant(const Identity& authority, std::string_view text, std::string_view unit,
                            const Validity& valid) {
  const auto name = name_in(text);
  if (!name) return tl::unexpected(name.error());
  const auto asking = asking_of(text);
  const auto issuer = certificate_of(authority.certificate);
  if (!issuer) return tl::unexpected(issuer.error());
  const auto key = key_of(authority.key);
  if (!key) return tl::unexpected(key.error());
  return certify(*name, unit, X509_REQ_get0_pubkey(asking->get()), valid, issuer->get(),
                 key->get());
}

Expected<std::string> revocation_list(const Identity& authority, const std::vector<Revoked>& gone,
                                      const Validity& valid) {
  const auto issuer = certificate_of(authority.certificate);
  if (!issuer) return tl::unexpected(issuer.error());
  const auto key = key_of(authority.key);
  if (!key) return tl::unexpected(key.error());
  const RevocationList list(X509_CRL_new());
  const Moment from(ASN1_TIME_set(nullptr, seconds_of(valid.from)));
  const Moment until(ASN1_TIME_set(nullptr, seconds_of(valid.until)));
  bool good = list && from && until && X509_CRL_set_version(list.get(), 1) == 1 &&
              X509_CRL_set_issuer_name(list.get(), X509_get_subject_name(issuer->get())) == 1 &&
              X509_CRL_set1_lastUpdate(list.get(), from.get()) == 1 &&
              X509_CRL_set1_nextUpdate(list.get(), until.get()) == 1;
  for (const Revoked& one : gone) {
    const Integer serial = serial_of(one.serial);
    const Moment when(ASN1_TIME_set(nullptr, seconds_of(one.when)));
    Owned<X509_REVOKED, X509_REVOKED_free> entry(X509_REVOKED_new());
    good = good && serial && when && entry &&
           X509_REVOKED_set_serialNumber(entry.get(), serial.get()) == 1 &&
           X509_REVOKED_set_revocationDate(entry.get(), when.get()) == 1 &&
           X509_CRL_add0_revoked(list.get(), entry.get()) == 1;
    if (good) entry.release();  // the list's now
  }
  good = good && X509_CRL_sort(list.get()) == 1 &&
         X509_CRL_sign(list.get(), key->get(), EVP_sha256()) > 0;
  const Bio text = writing();
  if (!good || PEM_write_bio_X509_CRL(text.get(), list.get()) != 1)
    return failed("the revocation list cannot be made");
  return text_of(text);
}

Expected<std::string> sign(const Identity& authority, std::string_view text) {
  const auto signer = certificate_of(authority.certificate);
  if (!signer) return tl::unexpected(signer.error());
  const auto key = key_of(authority.key);
  if (!key) return tl::unexpected(key.error());
  constexpr int flags = PKCS7_TEXT | PKCS7_DETACHED;
  const Bio content = reading(text);
  const Signed made(PKCS7_sign(signer->get(), key->get(), nullptr, content.get(), flags));
  const Bio out = writing();
  const Bio again = reading(text);
  if (!made || SMIME_write_PKCS7(out.get(), made.get(), again.get(), flags) != 1)
    return failed("the text cannot be signed");
  return text_of(out);
}

Expected<Facts> facts(std::string_view pem) {
  const auto certificate = certificate_of(pem);
  if (!certificate) return tl::unexpected(certificate.error());
  const X509* raw = certificate->get();
  return Facts{text_of_name(X509_get_subject_name(raw)),
               text_of_name(X509_get_issuer_name(raw)),
               text_of_serial(X509_get0_serialNumber(raw)),
               {time_of(X509_get0_notBefore(raw)), time_of(X509_get0_notAfter(raw))}};
}

Expected<Time> signed_at(std::string_view pem) {
  const auto list = list_of(pem);
  if (!list) return tl::unexpected(list.error());
  return time_of(X509_CRL_get0_lastUpdate(list->get())) + dated_back;
}

Expected<std::vector<Revoked>> revoked(std::string_view pem, std::string_view authority) {
  const auto list = list_of(pem);
  if (!list) return tl::unexpected(list.error());
  const auto issuer = certificate_of(authority);
  if (!issuer) return tl::unexpected(issuer.error());
  if (X509_CRL_verify(list->get(), X509_get0_pubkey(issuer->get())) != 1)
    return failed("the revocation list is not signed by this authority");
  std::vector<Revoked> gone;
  STACK_OF(X509_REVOKED)* entries = X509_CRL_get_REVOKED(list->get());
  for (int i = 0; i < sk_X509_REVOKED_num(entries); ++i) {
    const X509_REVOKED* entry = sk_X509_REVOKED_value(entries, i);
    gone.push_back({text_of_serial(X509_REVOKED_get0_serialNumber(entry)),
                    time_of(X509_REVOKED_get0_revocationDate(entry))});
  }
  return gone;
}

Expected<std::string> verified(std::string_view signed_text, std::string_view authority) {
  const auto signer = certificate_of(authority);
  if (!signer) return tl::unexpected(signer.error());
  const auto store = store_of(authority, nullptr);
  if (!store) return tl::unexpected(store.error());
  BIO* content_raw = nullptr;
  const Bio in = reading(signed_text);
  const Signed read(SMIME_read_PKCS7(in.get(), &content_raw));
  const Bio content(content_raw);
  if (!read || !content) return failed("is no signed text");
  const Owned<STACK_OF(X509), [](STACK_OF(X509) * stack) { sk_X509_free(stack); }> signers(
      sk_X509_new_null());
  if (!signers || sk_X509_push(signers.get(), signer->get()) == 0) return failed("no memory");
  const Bio out = writing();
  // The authority itself must have signed: certificates that come along do not count.
  if (PKCS7_verify(read.get(), signers.get(), store->get(), content.get(), out.get(),
                   PKCS7_TEXT | PKCS7_NOINTERN | PKCS7_NOVERIFY) != 1)
    return failed("was not signed by the authority of this lab");
  return text_of(out);
}

Expected<void> check(const Identity& identity, std::string_view authority, std::string_view list,
                     Time now) {
  const auto certificate = certificate_of(identity.certificate);
  if (!certificate) return tl::unexpected(certificate.error());
  const auto key = key_of(identity.key);
  if (!key) return tl::unexpected(key.error());
  if (X509_check_private_key(certificate->get(), key->get()) != 1)
    return failed("the private key belongs to another certificate");
  const auto gone = list_of(list);
  if (!gone) return tl::unexpected(gone.error());
  const auto store = store_of(authority, gone->get());
  if (!store) return tl::unexpected(store.error());
  const StoreContext context(X509_STORE_CTX_new());
  if (!context ||
      X509_STORE_CTX_init(context.get(), store->get(), certificate->get(), nullptr) != 1)
    return failed("the certificate cannot be checked");
  X509_VERIFY_PARAM_set_time(X509_STORE_CTX_get0_param(context.get()), seconds_of(now));
  if (X509_verify_cert(context.get()) != 1) {
    const char* why = X509_verify_cert_error_string(X509_STORE_CTX_get_error(context.get()));
    return failed(std::string("the certificate is not valid (") + why + ")");
  }
  return {};
}

}  // namespace prehend::keys
