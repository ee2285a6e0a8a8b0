#pragma once

#include <openssl/bio.h>
#include <openssl/pkcs7.h>
#include <openssl/x509.h>
#include <openssl/x509_vfy.h>

#include <memory>
#include <string>
#include <string_view>

#include "common/base/error.hpp"

/// OpenSSL's objects as values that free themselves.
namespace prehend::keys::openssl {

template <auto Free>
struct Deleter {
  template <class T>
  void operator()(T* object) const {
    Free(object);
  }
};
template <class T, auto Free>
using Owned = std::unique_ptr<T, Deleter<Free>>;

using Bio = Owned<BIO, BIO_free_all>;
using Certificate = Owned<X509, X509_free>;
using Key = Owned<EVP_PKEY, EVP_PKEY_free>;
using RevocationList = Owned<X509_CRL, X509_CRL_free>;
using Signed = Owned<PKCS7, PKCS7_free>;
using Store = Owned<X509_STORE, X509_STORE_free>;
using StoreContext = Owned<X509_STORE_CTX, X509_STORE_CTX_free>;

/// The last error of OpenSSL, which is then forgotten, as a failure of ours.
tl::unexpected<Error> failed(std::string what, std::string where = {}, std::string hint = {});

Bio reading(std::string_view text);
Bio writing();
std::string text_of(const Bio& bio);

Expected<Certificate> certificate_of(std::string_view pem);
Expected<Key> key_of(std::string_view pem);
Expected<RevocationList> list_of(std::string_view pem);

}  // namespace prehend::keys::openssl
